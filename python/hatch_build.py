"""Builds the kernel's shared library with Cargo and puts it into the wheel, with the replay page.

The library is loaded at run time by its C interface, so it depends on no version of Python. One
wheel serves all versions, and its tag names the platform only.

Two variables serve builds for another platform: `JCAS_WHEEL_LIBRARY` is a library that is built
already, and `JCAS_WHEEL_PLATFORM` is the platform's tag.

A source distribution takes the library's crates along, in the folder `kernel`.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SHARED_LIBRARY_SUFFIXES = (".so", ".dylib", ".dll")
# The library's crate and the crates of the workspace that it depends on.
CRATES = ("core", "simd", "policy", "plan", "trace", "ffi")
PAGE = "replay.html"
LICENSES = ("LICENSE-MIT", "LICENSE-APACHE")


class CargoBuildHook(BuildHookInterface):
    """Builds `jcas-ffi` in the workspace around this package, or in that of the source archive."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the library and a tag to a wheel, or the crates to a source distribution."""
        around = [Path(self.root).parent, Path(self.root) / "kernel"]
        workspace = next((path for path in around if (path / "ffi/Cargo.toml").is_file()), None)
        if workspace is None:
            raise RuntimeError(
                f"{around[0]} and {around[1]} hold no ffi/Cargo.toml: jcas for Python is built "
                "in a clone of the whole project (pip install ./python) or from its sdist"
            )
        if self.target_name == "sdist":
            self.add_crates(workspace, build_data)
        else:
            self.add_library(workspace, build_data)

    def add_library(self, workspace: Path, build_data: dict[str, Any]) -> None:
        """Copy the library beside the package and tag the wheel."""
        prebuilt = os.environ.get("JCAS_WHEEL_LIBRARY")
        library = Path(prebuilt) if prebuilt else build_library(workspace)
        native = Path(self.root) / "src" / "jcas" / "_native"
        native.mkdir(exist_ok=True)
        for stale in native.iterdir():
            stale.unlink()
        bundled = native / library.name
        shutil.copy2(library, bundled)
        if not prebuilt and library.suffix == ".so" and (strip := shutil.which("strip")):
            subprocess.run([strip, "--strip-unneeded", bundled], check=True)
        (native / PAGE).write_text(replay_page(workspace), encoding="utf-8")
        platform = os.environ.get("JCAS_WHEEL_PLATFORM") or sysconfig.get_platform()
        build_data["tag"] = f"py3-none-{platform.replace('-', '_').replace('.', '_')}"
        build_data["pure_python"] = False
        for name in LICENSES:
            build_data["extra_metadata"][str(workspace / name)] = name

    def add_crates(self, workspace: Path, build_data: dict[str, Any]) -> None:
        """Add the library's crates with a manifest that names only them."""
        manifest = (workspace / "Cargo.toml").read_text()
        members = ", ".join(f'"{crate}"' for crate in CRATES)
        lists = r"(?m)^members = \[[^\]]*\]$"
        manifest, found = re.subn(lists, f"members = [{members}]", manifest)
        if found != 1:
            raise RuntimeError(f"{workspace / 'Cargo.toml'}: {found} lists of members, must be 1")
        generated = Path(self.directory) / "kernel-Cargo.toml"
        generated.parent.mkdir(parents=True, exist_ok=True)
        generated.write_text(manifest)
        page = generated.with_name(PAGE)
        page.write_text(replay_page(workspace), encoding="utf-8")
        files = {str(generated): "kernel/Cargo.toml", str(page): f"kernel/{PAGE}"}
        for name in ("Cargo.lock", "rust-toolchain.toml", *LICENSES, *CRATES):
            files[str(workspace / name)] = f"kernel/{name}"
        build_data["force_include"].update(files)

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove what was generated."""
        for name in ("kernel-Cargo.toml", PAGE):
            (Path(self.directory) / name).unlink(missing_ok=True)


def replay_page(workspace: Path) -> str:
    """Put the page that plays an episode together; its title and its data are still marks."""
    if (workspace / PAGE).is_file():  # In a source archive.
        return (workspace / PAGE).read_text(encoding="utf-8")
    folder = workspace / "episode" / "src" / "replay"

    def part(name: str) -> str:
        return (folder / name).read_text(encoding="utf-8")

    scripts = re.findall(r'include_str!\("(\w+\.js)"\)', part("mod.rs"))
    marks = {
        "sources": "script-src 'unsafe-inline'",
        "style": part("style.css").rstrip(),
        "controls": "",
        "script": "\n".join(map(part, scripts)).rstrip(),
    }
    page = part("template.html")
    for mark, text in marks.items():
        page = page.replace(f"{{{{{mark}}}}}", text, 1)
    return page


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
