"""The environments in the registries of Gymnasium and PettingZoo: one id for each preset."""

from __future__ import annotations

import gymnasium
import pettingzoo

PRESETS = ("mission", "paper", "search", "isac")


def register() -> None:
    """Register `jcas/Fleet-v0` and the presets, `jcas/Paper-v0` for example.

    A process that has not imported jcas takes the module along: `gymnasium.make` of
    `jcas:jcas/Fleet-v0` imports it.
    """
    for name, config in [("Fleet", None), *((preset.title(), preset) for preset in PRESETS)]:
        identifier, options = f"jcas/{name}-v0", {} if config is None else {"config": config}
        if identifier in gymnasium.registry:
            continue
        gymnasium.register(
            id=identifier,
            entry_point="jcas.fleet:FleetEnv",
            vector_entry_point="jcas.vector:FleetVectorEnv",
            kwargs=options,
        )
        if hasattr(pettingzoo, "register"):  # from PettingZoo 1.27 on
            for kind, make in (("parallel", "parallel_env"), ("aec", "env")):
                pettingzoo.register(kind, identifier, f"jcas.parallel:{make}", kwargs=options)
