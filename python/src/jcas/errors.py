"""Errors that jcas raises. Kernel errors carry the C interface's status code and message."""

from __future__ import annotations


class JcasError(Exception):
    """Any error of jcas. `status` is the C interface's status code, or 0 for errors of Python."""

    def __init__(self, message: str, status: int = 0) -> None:
        super().__init__(message)
        self.status = status


class ConfigError(JcasError, ValueError):
    """A configuration is not legal; the message names the field, its value and its range."""


class UnknownFieldError(ConfigError, TypeError):
    """A keyword is no field of the configuration, nor an argument."""


class ArgumentError(JcasError, ValueError):
    """An argument is not allowed; the message names it, its value and the allowed values."""


class ActionError(JcasError, ValueError):
    """An action is NaN, has the wrong shape or is missing, or a network's output is not finite.

    The state is unchanged.
    """


class EpisodeOverError(JcasError, RuntimeError):
    """A step was called after the end of the episode. Reset first."""


class BusyError(JcasError, RuntimeError):
    """Another thread is using the object, or its buffers. Nothing has changed.

    An object serves one thread at a time: give each thread its own, or take turns with a lock. A
    `jcas.Model` serves any number of threads at once.
    """


class ResetNeededError(JcasError, RuntimeError):
    """The call needs an environment that has been reset."""


class SnapshotError(JcasError, ValueError):
    """Saved bytes are damaged, cut short, or belong to another configuration."""


class PolicyError(JcasError, ValueError):
    """A policy file cannot be read or does not fit, or a policy remembers another state."""


class PlanError(JcasError, ValueError):
    """A text is no plan, or one of another configuration."""


class MissingFileError(JcasError, FileNotFoundError):
    """A named file does not exist or cannot be read."""


class TraceError(JcasError, ValueError):
    """A trace file cannot be read, or its replay differs from the recording."""


class MissingDependencyError(JcasError, ImportError):
    """The call needs an optional package that is not installed."""

    def __init__(self, package: str, purpose: str, extra: str) -> None:
        super().__init__(f"{purpose} needs {package}: pip install 'jcas[{extra}]'")
