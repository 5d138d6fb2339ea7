"""Sweeps in shards: the bytes of one run, on one machine and on a cluster that loses processes."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from jcas.sweep import main, missing, names
from ray_nodes import two_nodes, wait_for

if not (os.environ.get("JCAS_COMMAND") or shutil.which("jcas")):
    pytest.skip("there is no jcas command", allow_module_level=True)

OPTIONS = ["--policy", "teams,random", "--uavs", "4,6", "--hotspots", "1,2,3", "--seed", "5"]
SHARDS = 6
RUN_SECONDS = 240
SWEEP_SECONDS = 40.0


def sweep(out, *options, episodes=20, shards=SHARDS):
    return ["--out", str(out), "--shards", str(shards), *options, "--", *OPTIONS, "--episodes",
            str(episodes)]  # fmt: skip


def whole(out, episodes=20):
    """The table of a run that is not cut into shards."""
    command = os.environ.get("JCAS_COMMAND") or "jcas"
    run = [command, "sweep", *OPTIONS, "--episodes", str(episodes), "--out", out, "--no-figures"]
    subprocess.run(run, check=True, capture_output=True)
    return (out / "results.csv").read_bytes()


def test_shards_give_the_bytes_of_one_run_and_go_on_where_they_ended(tmp_path, capsys):
    out = tmp_path / "out"
    assert main(sweep(out, "--serial")) == 0
    table = (out / "results.csv").read_bytes()
    assert table == whole(tmp_path / "whole") and missing(out, SHARDS) == []
    assert table.count(b"\n") == 13
    for name in names(2, SHARDS):
        (out / name).unlink()
    (out / names(5, SHARDS)[0]).unlink()
    capsys.readouterr()
    assert missing(out, SHARDS) == [2, 5] and main(sweep(out, "--serial")) == 0
    assert capsys.readouterr().out.startswith("5 of 6 shards\n6 of 6 shards\n")
    assert (out / "results.csv").read_bytes() == table


def test_shards_of_another_sweep_are_not_joined(tmp_path, capsys):
    assert main(sweep(tmp_path, "--serial", shards=2)) == 0
    (tmp_path / names(1, 2)[1]).unlink()
    assert main(sweep(tmp_path, "--serial", episodes=21, shards=2)) == 2
    assert "shard-" in capsys.readouterr().err
    assert main(sweep(tmp_path, "--serial", "--overwrite", episodes=21, shards=2)) == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--uavs", "0"], "uavs"),
        (["--policy", "team"], "team"),
        (["--vary", "speed=3"], "speed"),
        (["--sed", "1"], "--sed"),
    ],
)
def test_what_the_command_refuses_is_refused_in_its_words(tmp_path, capsys, options, message):
    assert main(["--out", str(tmp_path), "--shards", "2", "--serial", "--", *options]) == 2
    assert message in capsys.readouterr().err
    assert main(["--out", str(tmp_path), "--shards", "0", "--serial"]) == 2
    assert "--shards = 0" in capsys.readouterr().err


def test_without_the_command_one_is_asked_for(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("JCAS_COMMAND", raising=False)
    assert main(sweep(tmp_path, "--serial")) == 2
    assert "JCAS_COMMAND" in capsys.readouterr().err


def test_jobs_of_submitit_give_the_bytes_of_one_run(tmp_path):
    pytest.importorskip("submitit")
    example = Path(__file__).parents[2] / "examples" / "cluster" / "submitit_sweep.py"
    run = [sys.executable, example, *sweep(tmp_path / "out", "--cluster", "local", shards=2)]
    done = subprocess.run(run, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    assert (tmp_path / "out" / "results.csv").read_bytes() == whole(tmp_path / "whole")


@pytest.mark.heavy
def test_a_cluster_that_loses_worker_node_and_driver_gives_the_bytes_of_one_run(tmp_path, request):
    pytest.importorskip("ray")
    episodes, spent = 25, 0.0
    while spent < SWEEP_SECONDS / 10:  # Shards are left whenever the test ends a process.
        episodes *= 4
        begun = time.monotonic()
        whole(tmp_path / str(episodes), episodes)
        spent = time.monotonic() - begun
    episodes, shards = int(episodes * SWEEP_SECONDS / spent), 12
    out = tmp_path / "out"
    with two_nodes(tmp_path) as nodes:

        def start():
            options = sweep(out, "--address", nodes.address, episodes=episodes, shards=shards)
            process = subprocess.Popen(
                [sys.executable, "-m", "jcas.sweep", *options],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            )  # fmt: skip
            request.addfinalizer(process.kill)
            return process

        def workers():
            return [pid for pid, name in below(nodes.joined.pid) if name.startswith("ray::run_sh")]

        def finished():
            return shards - len(missing(out, shards))

        driver = start()
        wait_for(lambda: finished() >= 1, RUN_SECONDS, "the first shard")
        wait_for(workers, RUN_SECONDS, "a shard on the second node")
        os.kill(workers()[0], signal.SIGKILL)
        driver.kill()
        driver.communicate()
        kept = finished()
        assert 1 <= kept < shards

        driver = start()
        wait_for(lambda: finished() > kept, RUN_SECONDS, "shards after a killed driver")
        for pid, _ in [*below(nodes.joined.pid), (nodes.joined.pid, "")]:
            os.kill(pid, signal.SIGKILL)
        assert finished() < shards
        _, errors = driver.communicate(timeout=RUN_SECONDS)
        assert driver.returncode == 0, errors[-2000:]
    assert (out / "results.csv").read_bytes() == whole(tmp_path / "whole", episodes)


def below(pid):
    """Every process below another, with its name."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    for child in map(int, children):
        name = Path(f"/proc/{child}/cmdline").read_bytes().replace(b"\0", b" ").decode()
        yield child, name.strip()
        yield from below(child)
