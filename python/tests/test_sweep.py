"""Sweeps: every cell once, on one machine and on a cluster that loses processes."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("pyarrow")
pytest.importorskip("ray")

import pyarrow.parquet as pq

import jcas
from jcas.sweep import Sweep, Table, fly
from jcas.sweep.__main__ import main
from ray_nodes import two_nodes, wait_for

SPEC = """
episodes = {episodes}
seed = 5
[fields]
sensing_range_m = 150.0
[axes]
policy = ["teams", "random"]
uav_count = [4, 6]
hotspot_count = [1, 2, 3]
"""
CELLS = 12
RUN_SECONDS = 240
SWEEP_SECONDS = 40.0


def spec_file(folder, episodes=20, text=SPEC):
    path = folder / "sweep.toml"
    path.write_text(text.format(episodes=episodes))
    return path


def command(spec, out, *options):
    return [sys.executable, "-m", "jcas.sweep", str(spec), "--out", str(out), *options]


def serial(spec, out):
    assert main([str(spec), "--out", str(out), "--serial"]) == 0
    return (out / "results.csv").read_bytes()


def finished(out):
    file = out / "results.parquet"
    return pq.read_metadata(file).num_rows if file.exists() else 0


def lasting(folder, text):
    """Write a specification that takes SWEEP_SECONDS on one processor of this machine.

    Some of its cells are then left whenever the test ends a process, however fast the machine is.
    The timed sweep is long enough that what each cell costs beside its episodes does not count.
    """
    episodes, spent = 25, 0.0
    while spent < SWEEP_SECONDS / 10:
        episodes *= 4
        spec = spec_file(folder, episodes, text)
        begun = time.monotonic()
        serial(spec, folder / str(episodes))
        spent = time.monotonic() - begun
    return spec_file(folder, int(episodes * SWEEP_SECONDS / spent), text)


def test_a_table_has_every_combination_and_the_values_of_evaluate(tmp_path):
    lines = serial(spec_file(tmp_path), tmp_path / "out").decode().splitlines()
    assert len(lines) == CELLS + 1
    header, first = lines[0].split(","), lines[1].split(",")
    row = dict(zip(header, first, strict=True))
    assert header[:4] == ["policy", "pilot", "uav_count", "hotspot_count"]
    model = jcas.Model(uav_count=4, hotspot_count=1, sensing_range_m=150.0)
    report = jcas.evaluation.evaluate(
        jcas.Policy.baseline("teams", model), model, episodes=20, seed=5
    )
    assert row["config_hash"] == report.config_hash
    for quantity in report.quantities:
        assert float(row[quantity.name]) == quantity.value
        assert float(row[f"{quantity.name}_high"]) == quantity.high
    table = pq.read_table(tmp_path / "out" / "results.parquet")
    assert table["uav_count"].to_pylist()[:4] == [4, 4, 4, 6]


def test_a_trained_policy_is_found_from_the_folder_of_the_specification(tmp_path):
    shipped = Path(__file__).parents[2] / "policies" / "paper"
    (tmp_path / "mine").symlink_to(shipped)
    path = spec_file(tmp_path, text='config = "paper"\nepisodes = 2\n[axes]\npolicy = ["mine"]\n')
    sweep = Sweep.read(path)
    row, _ = fly(sweep.cells[0], sweep.weights["mine"])
    model = jcas.Model("paper")
    policy = jcas.Policy.load(shipped, model)
    report = jcas.evaluation.evaluate(policy, model, episodes=2)
    assert row["mission_steps_mean"] == report["mission_steps_mean"].value


def test_a_run_goes_on_where_it_ended(tmp_path):
    spec = spec_file(tmp_path)
    whole = serial(spec, tmp_path / "whole")
    sweep = Sweep.read(spec)
    table = Table(tmp_path / "parts", sweep)
    for index in (7, 2):
        table.add(index, fly(sweep.cells[index], None)[0])
    table.write()
    again = Table(tmp_path / "parts", sweep)
    assert again.missing() == [index for index in range(CELLS) if index not in (2, 7)]
    assert serial(spec, tmp_path / "parts") == whole


def test_another_sweep_is_not_continued(tmp_path, capsys):
    serial(spec_file(tmp_path), tmp_path / "out")
    other = spec_file(tmp_path, episodes=21)
    assert main([str(other), "--out", str(tmp_path / "out"), "--serial"]) == 2
    assert "is of another sweep" in capsys.readouterr().err
    assert main([str(other), "--out", str(tmp_path / "out"), "--serial", "--overwrite"]) == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("sed = 1", "sed: must be one of config, episodes"),
        ("episodes = 0", "episodes = 0: must be a whole number from 1"),
        ("axes = 3", "axes = 3: must be a table"),
        ("[axes]\nuav_count = 3", "axes.uav_count = 3: must be a list"),
        ("[axes]\nuav_count = [0]", "uav_count = 0: must be"),
        ("[axes]\npolicy = ['team']", "team"),
        ("[axes]\nspeed = [3]", "speed"),
        ("[fields]\nuav_count = 4\n[axes]\nuav_count = [3]", "must stand in one"),
        ("episodes = [", "not TOML"),
    ],
)
def test_a_wrong_specification_is_refused_by_name(tmp_path, capsys, text, message):
    spec = spec_file(tmp_path, text=text.replace("{", "{{"))
    assert main([str(spec), "--out", str(tmp_path / "out"), "--serial"]) == 2
    told = capsys.readouterr().err
    assert message in told and "sweep.toml" in told
    assert not (tmp_path / "out").exists()


def test_jobs_of_submitit_give_the_bytes_of_one_machine(tmp_path):
    pytest.importorskip("submitit")
    example = Path(__file__).parents[2] / "examples" / "cluster" / "submitit_sweep.py"
    spec, out = spec_file(tmp_path), tmp_path / "out"
    run = [sys.executable, example, spec, "--out", out, "--cluster", "local", "--jobs", "2"]
    told = subprocess.run(run, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr[-2000:]
    assert told.stdout.splitlines()[-1] == f"{CELLS} of {CELLS} cells"
    assert (out / "results.csv").read_bytes() == serial(spec, tmp_path / "serial")


@pytest.mark.heavy
def test_a_cluster_that_loses_worker_node_and_driver_gives_the_bytes_of_one_machine(
    tmp_path, request
):
    text = SPEC.replace("[1, 2, 3]", "[1, 2, 3, 4, 5, 6, 7, 8, 9]")
    spec, cells = lasting(tmp_path, text), 3 * CELLS
    out = tmp_path / "out"
    with two_nodes(tmp_path) as nodes:

        def start():
            process = subprocess.Popen(
                command(spec, out, "--address", nodes.address, "--json"),
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            )
            request.addfinalizer(process.kill)
            return process

        driver = start()
        wait_for(lambda: finished(out) >= 1, RUN_SECONDS, "the first cell")

        def workers():
            return [pid for pid, name in below(nodes.joined.pid) if name.startswith("ray::fly")]

        wait_for(workers, RUN_SECONDS, "a cell on the second node")
        os.kill(workers()[0], signal.SIGKILL)
        # The next rows may come late: after a slow write the driver waits before it writes again.
        driver.kill()
        driver.communicate()
        kept = finished(out)
        assert 1 <= kept < cells

        driver = start()
        wait_for(lambda: finished(out) > kept, RUN_SECONDS, "cells after a killed driver")
        for pid, _ in [*below(nodes.joined.pid), (nodes.joined.pid, "")]:
            os.kill(pid, signal.SIGKILL)
        assert finished(out) < cells
        told, errors = driver.communicate(timeout=RUN_SECONDS)
        assert driver.returncode == 0, errors[-2000:]
        assert json.loads(told.splitlines()[-1])["failed"] == [], told
    assert (out / "results.csv").read_bytes() == serial(spec, tmp_path / "serial")


def below(pid):
    """Every process below another, with its name."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    for child in map(int, children):
        name = Path(f"/proc/{child}/cmdline").read_bytes().replace(b"\0", b" ").decode()
        yield child, name.strip()
        yield from below(child)
