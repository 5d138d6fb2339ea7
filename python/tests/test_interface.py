"""The declarations are those of the header, and the library is the one they were made for."""

import ctypes
import os
import re
import subprocess
import sys
from pathlib import Path

import jcas
from jcas import _abi
from jcas._library import lib

PYTHON = Path(__file__).parents[1]


def test_the_declarations_are_fresh():
    subprocess.run([sys.executable, PYTHON / "generate_abi.py", "--check"], check=True)


def test_the_generator_sees_every_function_of_the_header():
    header = (PYTHON.parent / "include" / "jcas.h").read_text()
    declared = re.findall(
        r"^(?:JCAS_API |JCAS_NODISCARD )*(?:jcas_status |const char \*|uint\d+_t )(jcas_\w+)\(",
        header,
        re.MULTILINE,
    )
    written = (PYTHON / "src" / "jcas" / "_abi.py").read_text().count(".argtypes")
    assert written == len(declared) > 50


def test_the_library_knows_every_struct_size():
    config = _abi.jcas_config()
    assert lib.jcas_config_default(ctypes.byref(config), ctypes.sizeof(config)) == _abi.JCAS_OK
    assert (
        lib.jcas_config_default(ctypes.byref(config), ctypes.sizeof(config) - 8)
        == _abi.JCAS_ERROR_STRUCT_SIZE
    )
    assert (config.uav_count, config.grid_height, config.shaping_charge_weight) == (10, 12, 0.1)


def test_versions_agree():
    from importlib.metadata import PackageNotFoundError, version

    library = lib.jcas_version().decode()
    assert (
        library == f"{_abi.JCAS_VERSION_MAJOR}.{_abi.JCAS_VERSION_MINOR}.{_abi.JCAS_VERSION_PATCH}"
    )
    try:
        assert version("jcas") == library
    except PackageNotFoundError:
        # Run from the source tree with JCAS_LIBRARY, without an install.
        assert "JCAS_LIBRARY" in os.environ


def test_models_sims_and_batches_are_freed_in_any_order():
    code = (
        "import gc, jcas, numpy as np\n"
        "class Knot: pass\n"
        "for _ in range(200):\n"
        "    model = jcas.Model(uav_count=3); sim = jcas.Sim(model); batch = jcas.Batch(model, 2)\n"
        "    knot = Knot(); knot.self = knot; knot.all = (model, sim, batch, sim.fork(), "
        "batch.member(1))\n"
        "    del model, sim, batch, knot\n"
        "gc.collect()\n"
        "left = jcas.Sim(jcas.Model())\n"
        "print('alive', left.step(np.zeros((10, 2), np.float32)).reward)\n"
    )
    output = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout
    assert output.startswith("alive")


def test_a_missing_library_says_what_to_do(tmp_path):
    complaint = subprocess.run(
        [sys.executable, "-c", "import jcas"],
        env={**os.environ, "JCAS_LIBRARY": str(tmp_path / "no.so")},
        capture_output=True,
        text=True,
    ).stderr
    assert "cannot load the kernel's library" in complaint and "no.so" in complaint
    assert issubclass(jcas.ConfigError, ValueError) and issubclass(jcas.ConfigError, jcas.JcasError)


def test_the_readme_names_every_extra_of_users():
    project = (PYTHON / "pyproject.toml").read_text(encoding="utf-8")
    table = project.split("[project.optional-dependencies]\n")[1].split("\n[")[0]
    extras = set(re.findall(r"^(\w+) = \[", table, re.MULTILINE)) - {"test"}
    named = (PYTHON / "README.md").read_text(encoding="utf-8").split("everything else is an extra:")
    assert set(re.findall(r"`(\w+)`", named[1].split("\n\n")[0])) == extras
