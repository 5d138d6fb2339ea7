"""Builds the kernel's shared library with Cargo and puts it into the wheel.

The library is loaded at run time by its C interface, so it depends on no version of Python. One
wheel serves all versions, and its tag names the platform only.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SHARED_LIBRARY_SUFFIXES = (".so", ".dylib", ".dll")


class CargoBuildHook(BuildHookInterface):
    """Runs `cargo build` for `jcas-ffi` in the workspace that this package lies in."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the library, copy it beside the package and tag the wheel."""
        workspace = Path(self.root).parent
        if not (workspace / "ffi" / "Cargo.toml").is_file():
            raise RuntimeError(
                f"{workspace} holds no ffi/Cargo.toml: "
                "jcas for Python is built inside a clone of the whole "
                "project (pip install ./python)"
            )
        library = build_library(workspace)
        native = Path(self.root) / "src" / "jcas" / "_native"
        native.mkdir(exist_ok=True)
        for stale in native.iterdir():
            stale.unlink()
        bundled = native / library.name
        shutil.copy2(library, bundled)
        if library.suffix == ".so" and (strip := shutil.which("strip")):
            subprocess.run([strip, "--strip-unneeded", bundled], check=True)
        platform = os.environ.get("JCAS_WHEEL_PLATFORM") or sysconfig.get_platform()
        build_data["tag"] = f"py3-none-{platform.replace('-', '_').replace('.', '_')}"
        build_data["pure_python"] = False


def build_library(workspace: Path) -> Path:
    """Build the release library and return the file that Cargo says it wrote."""
    cargo = shutil.which("cargo")
    if cargo is None:
        raise RuntimeError(
            "cargo is not on the PATH: install Rust (https://rustup.rs) to build jcas from source"
        )
    command = [
        cargo,
        "build",
        "--release",
        "--package",
        "jcas-ffi",
        "--message-format",
        "json-render-diagnostics",
    ]
    output = subprocess.run(
        command, cwd=workspace, check=True, stdout=subprocess.PIPE, text=True
    ).stdout
    for line in output.splitlines():
        message = json.loads(line)
        if (
            message.get("reason") == "compiler-artifact"
            and "cdylib" in message["target"]["crate_types"]
        ):
            for name in message["filenames"]:
                if name.endswith(SHARED_LIBRARY_SUFFIXES):
                    return Path(name)
    raise RuntimeError(f"{' '.join(command)} wrote no shared library")
