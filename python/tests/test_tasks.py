"""Evaluations, and the ladder of named tasks with its plain learner."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import jcas
from jcas.evaluation import evaluate, rliable_scores
from jcas.tasks import TASKS, measure

LEARNER = Path(__file__).parents[2] / "examples" / "cleanrl_ppo.py"


def test_scores_are_those_behind_the_means():
    model = jcas.Model(uav_count=4, hotspot_count=2, horizon_steps=30)
    report = evaluate(jcas.Policy.baseline("teams", model), model, episodes=20, seed=3)
    assert set(report.scores) > {"success", "mission_steps", "energy_kwh", "return_sum"}
    assert report.scores["success"].mean() == report["success_rate"].value
    assert report.scores["mission_steps"].mean() == report["mission_steps_mean"].value
    other = evaluate(jcas.Policy.baseline("random", model), model, episodes=20, seed=3)
    scores = rliable_scores({"teams": [[report, other]] * 3, "random": [[other, other]]})
    assert scores["teams"].shape == (3, 2) and scores["random"].shape == (1, 2)
    assert scores["teams"][0, 0] == report["success_rate"].value


def test_memory_begins_anew_and_actions_may_be_discrete():
    class Counting:
        missions = 0

        def reset(self, missions):
            self.missions += missions
            self.steps = 0

        def __call__(self, observations):
            self.steps += 1
            return np.full(observations.shape[:2], 12)

    model, act = jcas.Model(uav_count=3, horizon_steps=5), Counting()
    report = evaluate(act, model, episodes=300, action_space="discrete")
    assert act.missions == 300 and act.steps == 5
    assert report["pilot_density_mean"].value == pytest.approx(model.config["pilot_density_min"])


def test_tasks_grow_harder_and_train_on_the_same_missions():
    random = []
    for task in TASKS.values():
        assert task.config(training=True).replace(**dict(task.config())) == task.config()
        stages = [jcas.Model(config) for config in task.curriculum(3)]
        ranges = [model.sensing_range(0.3) for model in stages]
        assert ranges == sorted(ranges, reverse=True) and ranges[0] > ranges[2]
        assert stages[-1].config == task.config(training=True)
        model = jcas.Model(task.config())
        report = evaluate(jcas.Policy.baseline("random", model), model, episodes=40)
        random.append(report["mission_steps_mean"].value)
    assert random[0] < 25 and next(iter(TASKS)) == "meet"


def test_scripts_plans_and_the_bound_of_the_easiest_task():
    rows = measure(TASKS["meet"], 20)
    assert rows["teams"][0] == rows["replan"][0] == 1.0 > rows["random"][0]
    # The bound is one of the expected steps, and the rest are means of twenty missions.
    assert 0 < rows["bound"][1] < rows["replan"][1] + 1 < rows["random"][1]


@pytest.mark.heavy
def test_the_plain_learner_learns_the_easiest_task(tmp_path):
    """In fifteen seconds of one processor, of which two minutes may be spent."""
    pytest.importorskip("torch")
    curve = tmp_path / "curve.csv"
    done = subprocess.run(
        [sys.executable, LEARNER, "--task", "meet", "--seconds", "15", "--curve", curve],
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    assert float(re.search(r"success rate +([\d.]+)", done.stdout)[1]) > 0.9, done.stdout
    rows = curve.read_text().splitlines()
    assert rows[0] == "processor_s,steps,success" and float(rows[1].split(",")[2]) < 0.6
