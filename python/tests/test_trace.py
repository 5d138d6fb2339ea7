"""Golden traces, recorded by the command line, fly the same through Python to the last bit."""

import json
from pathlib import Path

import pytest

import jcas

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
    assert sim.metrics() == trace.end["metrics"]


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


def test_a_trace_that_does_not_come_out_says_where():
    trace = jcas.Trace.load(FILES[0])
    trace.steps[1]["state_hash"] = "0x" + "0" * 16
    with pytest.raises(jcas.TraceError, match="step 2: state_hash"):
        jcas.replay_trace(trace)
    trace = jcas.Trace.load(FILES[0])
    trace.header["initial"]["battery_uj"][0] -= 1
    with pytest.raises(jcas.TraceError, match="reset: battery_uj"):
        jcas.replay_trace(trace)
