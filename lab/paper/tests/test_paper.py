"""The lists, the tables, the test of agreement, and the page beside its tables."""

import json
import re
import stat
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from paper import __main__ as command
from paper import claims, experiments, figures, likelihood, page, tables
from paper import run as runner
from paper.experiments import ExperimentError

FAKE = """#!/bin/sh
# A stand-in for jcas and jcas-lab: writes a policy, or prints a report.
echo "$@" >>"$LOG"
if [ "$1" = train ]; then
    while [ "$1" != --out ]; do shift; done
    mkdir -p "$2" && echo weights >"$2/policy.safetensors"
    echo iteration,return_mean,success_rate,wall_s >"$2/metrics.csv"
    echo 1,2.5,0.5,3.25 >>"$2/metrics.csv"
else
    cat "$REPORT"
fi
"""


@pytest.fixture
def tools(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> runner.Tools:
    """Stand-ins for the commands, and tables in a folder of their own."""
    fake = tmp_path / "fake"
    fake.write_text(FAKE)
    fake.chmod(fake.stat().st_mode | stat.S_IXUSR)
    report = {field: 0.5 + k for k, field in enumerate(runner.QUANTITIES.values())}
    (tmp_path / "report.json").write_text(json.dumps(report))
    monkeypatch.setenv("REPORT", str(tmp_path / "report.json"))
    monkeypatch.setenv("LOG", str(tmp_path / "log"))
    monkeypatch.setattr(tables, "RUNS", tmp_path / "runs.csv")
    monkeypatch.setattr(tables, "TRAININGS", tmp_path / "trainings.csv")
    monkeypatch.setattr(tables, "WEIGHTS", tmp_path / "weights")
    return runner.Tools(str(fake), str(fake), tmp_path / "runs", "abc1234", 1)


def test_every_list_parses_and_names_each_run_once() -> None:
    runs = [run for name in experiments.names() for run in experiments.read(name)]
    keys = [tables.key_of(key) for run in runs for key in run.keys()]
    assert len(keys) == len(set(keys)) > 200


def test_each_half_of_a_seed_has_every_value_equally_often() -> None:
    runs = experiments.read("b-symmetric")
    assert len(runs) == 24
    for start in range(0, 24, 4):
        for axis in ("inform_payment", "sensing_range_m", "uavs"):
            values = [run[axis] for run in runs[start : start + 4]]
            assert {values.count(value) for value in values} == {2}, (start, axis)
    assert [run["seed"] for run in runs] == sorted(run["seed"] for run in runs)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"axis": {}}, ["key", "axis", "axes"]),
        ({"axes": {"uavs": []}}, ["uavs", "[]", "at least one"]),
        ({"modes": ["card"]}, ["modes", "card", "sampled"]),
        ({"episodes": 0}, ["episodes", "0", "at least 1"]),
    ],
)
def test_a_bad_list_is_refused_by_key_value_and_range(table: dict, words: list[str]) -> None:
    with pytest.raises(ExperimentError) as refusal:
        experiments.parse("bad", table)
    assert all(word in str(refusal.value) for word in words)


def test_a_run_is_trained_evaluated_in_both_modes_and_not_repeated(
    tools: runner.Tools, tmp_path: Path
) -> None:
    run = experiments.read("b-symmetric")[0]
    runner.run_list([run], tools)
    rows = tables.read(tables.RUNS)
    assert list(rows["mode"]) == ["sampled", "deterministic"]
    assert set(rows["success"]) == {0.5}
    assert set(rows["train_seconds"]) == {3.2}
    assert (tables.WEIGHTS / f"{run.name}.safetensors").read_text() == "weights\n"
    assert list(tables.read(tables.TRAININGS)["return_mean"]) == [2.5]
    calls = (tmp_path / "log").read_text().splitlines()
    assert len(calls) == 3
    assert "--set motion_map=symmetric" in calls[0] and "--resume" in calls[0]
    assert "--mode deterministic" in calls[2]
    runner.run_list([run], tools)
    assert (tmp_path / "log").read_text().splitlines() == calls


def test_a_command_that_fails_is_named_and_leaves_no_row(tools: runner.Tools) -> None:
    broken = runner.Tools(tools.jcas, "false", tools.folder, tools.sources, 1)
    with pytest.raises(runner.RunError, match="status 1"):
        runner.run_list(experiments.read("b-symmetric")[:1], broken)
    assert tables.read(tables.RUNS).empty


def test_an_unknown_list_ends_with_status_two(capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main(["run", "nothing", "--dry-run"]) == 2
    assert "b-symmetric" in capsys.readouterr().err


def trainings(mean: float, tau: float, seeds: int = 3) -> pd.DataFrame:
    """Drawn rows of ten cells with a common mean on the logit scale."""
    draws = np.random.default_rng(7)
    rows = []
    for uavs, shift in ((10, 0.0), (15, 2.48)):
        for hotspots in likelihood.HOTSPOTS:
            for _ in range(seeds):
                rate = 1 / (1 + np.exp(-(mean + shift + tau * draws.standard_normal())))
                share = draws.binomial(1000, rate) / 1000
                rows.append({"uavs": uavs, "hotspots": hotspots, "episodes": 1000})
                rows[-1]["success"] = share
    return pd.DataFrame(rows)


def test_rates_like_the_papers_agree_and_others_do_not() -> None:
    alike = likelihood.test(trainings(np.log(0.73 / 0.27), 0.4))
    assert not alike.rejected and 0.2 < alike.tau < 0.7
    lower = likelihood.test(trainings(np.log(0.5 / 0.5), 0.4))
    assert lower.rejected and lower.statistic > alike.statistic


def test_a_condition_with_a_missing_cell_is_not_tested() -> None:
    table = trainings(1.0, 0.4)
    with pytest.raises(ValueError, match="N = 15, n = 11"):
        likelihood.test(table[~((table.uavs == 15) & (table.hotspots == 11))])


def test_the_probabilities_of_all_numbers_of_successes_add_to_one() -> None:
    log_p = likelihood.log_marginal(np.arange(101.0), 100, 0.8, 0.5)
    assert np.exp(log_p).sum() == pytest.approx(1.0, abs=1e-9)


def test_verdicts_follow_from_intervals() -> None:
    assert claims.judge((0.5, 0.4, 0.6), 0.3, 0.7) == "holds"
    assert claims.judge((0.5, 0.4, 0.6), 0.7, 0.9) == "fails"
    assert claims.judge((0.5, 0.4, 0.6), 0.5, 0.9) == "open"
    assert claims.worst(["holds", "open", "fails"]) == "fails"


def test_a_table_with_other_columns_is_refused(tmp_path: Path) -> None:
    (tmp_path / "runs.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="expected"):
        tables.read(tmp_path / "runs.csv")


def test_the_page_is_what_the_tables_give() -> None:
    assert page.PAGE.read_text(encoding="utf-8") == page.render()
    words = re.sub(r"!?\[([^]]*)\]\([^)]*\)|[|`#*-]", r"\1 ", page.PAGE.read_text()).split()
    assert len(words) <= 1500


def test_the_figures_are_what_the_tables_give(tmp_path: Path) -> None:
    figures.write(tables.read(tables.RUNS), tmp_path)
    for name in figures.FIGURES:
        made = series((tmp_path / f"{name}.svg").read_text())
        kept = series((tables.RESULTS / "figures" / f"{name}.svg").read_text())
        assert len(made) == len(kept) and np.allclose(made, kept, atol=0.02), name


def series(svg: str) -> np.ndarray:
    """The coordinates of every path, which other releases of the library may round differently."""
    paths = re.findall(r'<path d="([^"]*)"', svg)
    return np.array([float(x) for path in paths for x in re.findall(r"-?\d+\.?\d*", path)])
