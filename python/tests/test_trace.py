"""Golden traces, recorded by the command line, fly the same through Python to the last bit."""

import ctypes
import html
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import jcas
from jcas import _abi
from jcas._library import check, lib

GOLDEN = Path(__file__).parents[2] / "tests" / "golden"
FILES = sorted(GOLDEN.glob("*.jsonl"))


def test_there_are_golden_traces():
    assert len(FILES) >= 5


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_golden_traces_replay_with_identical_hashes(path):
    trace = jcas.Trace.load(path)
    moments = []
    sim = jcas.replay_trace(trace, watch=lambda sim: moments.append(sim.t))
    assert moments == list(range(len(trace.steps) + 1))
    assert f"0x{sim.state_hash():016x}" == trace.steps[-1]["state_hash"]
    # A trace leaves the false confirmations out where there are none.
    assert sim.metrics() == {"false_confirmations": 0, **trace.end["metrics"]}


def test_a_trace_that_was_changed_is_refused(tmp_path):
    lines = FILES[0].read_text().splitlines(keepends=True)
    changed = tmp_path / "changed.jsonl"
    changed.write_text("".join(lines[:2] + lines[3:]))
    with pytest.raises(jcas.TraceError, match="checksum"):
        jcas.Trace.load(changed)
    changed.write_text("".join(lines[:-1]))
    with pytest.raises(jcas.TraceError, match="cut short"):
        jcas.Trace.load(changed)
    changed.write_text("{")
    with pytest.raises(jcas.TraceError, match="JSON"):
        jcas.Trace.load(changed)
    changed.write_text(json.dumps({"kind": "header", "format": "other"}))
    with pytest.raises(jcas.TraceError, match="jcas-trace"):
        jcas.Trace.load(changed)


def sealed(text: bytes) -> bytes:
    """Give a text that was changed the checksum that fits: FNV-1a, 64 bits."""
    body = text[: text.rindex(b',"checksum":')]
    value = 0xCBF29CE484222325
    for byte in body:
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return body + b',"checksum":"0x%016x"}\n' % value


def test_a_trace_that_does_not_come_out_says_where(tmp_path):
    changed = tmp_path / "changed.jsonl"
    text = FILES[0].read_bytes()
    changed.write_bytes(text.replace(b'"t":2,', b'"t":3,', 1))
    with pytest.raises(jcas.TraceError, match="checksum"):
        jcas.Trace.load(changed)
    changed.write_bytes(sealed(text.replace(b'"t":2,', b'"t":3,', 1)))
    moments = []
    with pytest.raises(jcas.TraceError, match="line 3: t differs"):
        jcas.replay_trace(changed, watch=lambda sim: moments.append(sim.t))
    assert moments == [0, 1]
    changed.write_bytes(sealed(text.replace(b'"battery_uj":[', b'"battery_uj":[1', 1)))
    with pytest.raises(jcas.TraceError, match="changed.jsonl: line 1: battery_uj differs"):
        jcas.replay_trace(changed)
    changed.write_bytes(sealed(text.replace(b'"quorum":', b'"quorum":-', 1)))
    with pytest.raises(jcas.TraceError, match="line 1: quorum"):
        jcas.Trace.load(changed)


def record_hosted() -> bytes:
    """Record, through the C interface, an episode with every kind of host control."""
    model = jcas.Model(jcas.Config(uav_count=3, hotspot_count=2, horizon_steps=20))
    sim = jcas.Sim(model)
    recorder = jcas.Recorder(sim, 5)
    cell = ctypes.POINTER(_abi.jcas_cell)
    cells = np.array([[1, 1], [2, 2], [3, 3]], np.uint32)
    charges = np.array([5 * 10**11, 10**11, 1], np.uint64)
    actions = np.zeros((3, 2), np.float32)
    links = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]], np.uint8)
    seen = np.ones((3, 2), np.uint8)
    throughput = np.array([0.5, 0.25, 0.0])
    outcome = ctypes.byref(sim._outcome)
    check(lib.jcas_sim_set_starts(sim.handle, cells.ctypes.data_as(cell), 3))
    check(lib.jcas_sim_set_hotspots(sim.handle, cells.ctypes.data_as(cell), 2))
    check(lib.jcas_sim_set_batteries(sim.handle, charges.ctypes.data, 3))
    check(lib.jcas_sim_step(sim.handle, actions.ctypes.data, 6, outcome))
    for step in range(4):
        check(lib.jcas_sim_set_battery(sim.handle, 2, 10**11 + step))
        check(lib.jcas_sim_move_hotspot(sim.handle, 0, 7, step))
        check(lib.jcas_sim_step_begin(sim.handle, actions.ctypes.data, 6))
        check(lib.jcas_sim_set_positions(sim.handle, cells.ctypes.data_as(cell), 3))
        check(lib.jcas_sim_ground(sim.handle, 0))
        check(lib.jcas_sim_confirm_hotspot(sim.handle, 1))
        if step % 2:
            check(lib.jcas_sim_step_sense_with(sim.handle, seen.ctypes.data, 6))
            check(lib.jcas_sim_step_communicate(sim.handle))
        else:
            check(lib.jcas_sim_step_sense(sim.handle))
            measured = (throughput.ctypes.data, 3) if step else (None, 0)
            check(lib.jcas_sim_step_communicate_with(sim.handle, links.ctypes.data, 9, *measured))
        check(lib.jcas_sim_step_end(sim.handle, outcome))
    check(lib.jcas_sim_set_battery(sim.handle, 0, 9))
    return recorder.trace().text


def test_what_a_host_supplied_flies_the_same_again(tmp_path):
    file = tmp_path / "hosted.jsonl"
    file.write_bytes(record_hosted())
    trace = jcas.Trace.load(file)
    assert [len(calls) for calls in trace.host] == [3, 6, 6, 6, 6, 1]
    sim = jcas.replay_trace(trace)
    assert (
        f"0x{sim.state_hash():016x}" != trace.steps[-1]["state_hash"]
    )  # the last call changed a battery
    moved = file.read_bytes().split(b"\n")
    line = next(at for at, text in enumerate(moved) if b"set_positions" in text)
    moved[line] = (
        b'{"kind":"set_positions","cells":[[1,1],[9,9],[3,3]]}'  # the first is grounded, and stays
    )
    file.write_bytes(sealed(b"\n".join(moved)))
    with pytest.raises(jcas.TraceError, match=r"line \d+: positions differs"):
        jcas.replay_trace(file)


def page_data(page: str) -> dict:
    return json.loads(page.split('id="episode">')[1].split("</script>")[0])


def test_an_episode_is_recorded_saved_and_shown(tmp_path):
    policy = jcas.Policy.baseline("teams", jcas.Model(uav_count=6, hotspot_count=2))
    trace = jcas.run_episode(policy, seed=3)
    assert repr(trace) == f"<jcas.Trace of teams, seed 3: success in {len(trace.steps)} steps>"
    trace.save(tmp_path / "episode.jsonl")
    assert jcas.replay_trace(tmp_path / "episode.jsonl").terminated
    page = trace.to_html()
    assert "{{" not in page and 'src="' not in page and "@import" not in page
    assert set(json.loads(page.split('id="presets">')[1].split("</script>")[0])["presets"]) == {
        "mission",
        "paper",
        "search",
        "isac",
    }
    data = page_data(page)
    assert data["header"] == trace.header and data["end"] == trace.end
    assert [step["t"] for step in data["steps"]] == list(range(1, len(trace.steps) + 1))
    trace.save_html(tmp_path / "episode.html")
    assert (tmp_path / "episode.html").read_text(encoding="utf-8") == page
    shown = trace._repr_html_()
    assert html.unescape(shown.split('srcdoc="')[1].split('"></iframe>')[0]) == page


def test_the_page_is_that_of_the_command(tmp_path):
    command = os.environ.get("JCAS_COMMAND")
    if command is None:
        pytest.skip("JCAS_COMMAND names no jcas command")
    for file in (FILES[0], tmp_path / "hosted.jsonl"):
        if not file.exists():
            file.write_bytes(record_hosted())
        out = tmp_path / "page.html"
        subprocess.run([command, "replay", file, "--out", out], check=True, capture_output=True)
        theirs, own = (
            page_data(page)
            for page in (out.read_text(encoding="utf-8"), jcas.Trace.load(file).to_html())
        )
        assert theirs["header"] == own["header"] and theirs["end"] == own["end"]
        assert theirs.get("hosted") == own.get("hosted")
        for step, mine in zip(theirs["steps"], own["steps"], strict=True):
            assert step == {name: mine[name] for name in step}


def test_a_function_is_recorded_with_its_memory_begun_anew():
    class Still:
        begun = 0

        def reset(self, missions):
            self.begun += missions

        def __call__(self, observations):
            assert observations.shape == (1, 3, model.observation_len)
            return np.full((1, 3), 12)  # stay, lowest pilot density

    model, still = jcas.Model(uav_count=3, horizon_steps=5), Still()
    trace = jcas.run_episode(still, model, seed=2, name="still", action_space="discrete")
    assert still.begun == 1 and "still" in repr(trace) and "no success in 5 steps" in repr(trace)
    np.testing.assert_allclose(trace.actions(0), [[0.8, -1]] * 3, atol=1e-6)


def test_a_reset_ends_a_recording_without_a_trace():
    sim = jcas.Sim(jcas.Model(uav_count=3))
    recorder = jcas.Recorder(sim, 5)
    sim.reset(6)
    with pytest.raises(jcas.JcasError):
        recorder.trace()
