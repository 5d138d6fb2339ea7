"""Policies: written, read, refused, and flown with a report."""

import json
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import jcas
from jcas.evaluation import bootstrap_means, evaluate, wilson
from jcas.policy import Layer


def made(model, head="gaussian", hidden=16, seed=0, **options):
    rng = np.random.default_rng(seed)
    outputs = {"gaussian": 4, "hybrid": 7}[head]
    widths = [model.observation_len, hidden, outputs]
    layers = [
        Layer(
            rng.normal(0, 0.5, (i, o)).astype(np.float32), rng.normal(0, 0.5, o).astype(np.float32)
        )
        for i, o in pairwise(widths)
    ]
    return jcas.MlpPolicy(layers, head, **options)


@pytest.mark.parametrize("head", ["gaussian", "hybrid"])
def test_a_written_policy_flies_as_its_layers_say(tmp_path, head):
    """The most likely motion and the mean pilot density, worked out here by hand."""
    pytest.importorskip("safetensors")
    model = jcas.Model(uav_count=4)
    inputs = (
        np.full(model.observation_len, 0.5, np.float32),
        np.full(model.observation_len, 2, np.float32),
    )
    policy = made(model, head, inputs=inputs)
    policy.save(tmp_path / "p", "test", model.config, {"seed": 3})
    assert json.loads((tmp_path / "p" / "policy.json").read_text())["seed"] == 3
    assert sorted(os.listdir(tmp_path / "p")) == ["policy.json", "policy.safetensors"]
    assert jcas.trained_on(tmp_path / "p") == model.config
    flown, sim = jcas.Policy.load(tmp_path / "p", model), jcas.Sim(model, 4)
    first, last = policy.layers
    for _ in range(5):
        hidden = np.clip((sim.observe() - inputs[0]) / inputs[1], -10, 10)
        outputs = np.maximum(hidden @ first.weight + first.bias, 0) @ last.weight + last.bias
        if head == "gaussian":
            expected = np.clip(outputs[:, :2], -1, 1)
        else:
            concentration = 1 + np.logaddexp(0, outputs[:, 5:])
            motion = -0.8 + 0.4 * outputs[:, :5].argmax(axis=1)
            expected = np.stack(
                [motion, 2 * concentration[:, 0] / concentration.sum(axis=1) - 1], axis=1
            )
        actions = flown.act(sim)
        np.testing.assert_allclose(actions, expected, atol=1e-4)
        sim.step(actions)


def test_policies_that_cannot_be_are_refused():
    model = jcas.Model(uav_count=4)
    policy = made(model)
    with pytest.raises(jcas.PolicyError, match="must have 7"):
        jcas.MlpPolicy(policy.layers, "hybrid")
    with pytest.raises(jcas.PolicyError, match="do not follow"):
        jcas.MlpPolicy(policy.layers[::-1])


def test_numbers_that_are_not_finite_never_become_actions_in_silence(tmp_path):
    pytest.importorskip("safetensors")
    model = jcas.Model(uav_count=4)
    ones = np.ones(model.observation_len, np.float32)
    first, last = made(model).layers
    for value in (np.nan, np.inf):
        weight = first.weight.copy()
        weight[2, 3] = value
        with pytest.raises(jcas.PolicyError, match=r"layers\[0\]\.weight\[2, 3\] = (nan|inf)"):
            jcas.MlpPolicy([Layer(weight, first.bias), last])
        with pytest.raises(jcas.PolicyError, match=r"the mean of inputs\[0\] = (nan|inf)"):
            jcas.MlpPolicy([first, last], inputs=(ones * value, ones))
    # Weights that are finite, with outputs that are not.
    huge = np.full_like(last.weight, 3e38)
    policy = jcas.MlpPolicy([first, Layer(huge, last.bias)])
    policy.save(tmp_path / "p", "huge", model.config, {})
    flown = jcas.Policy.load(tmp_path / "p", model)
    with pytest.raises(jcas.ActionError, match="not finite"):
        flown.act(jcas.Sim(model, 4))
    with pytest.raises(jcas.ActionError, match="not finite"):
        flown.act_batch(jcas.Batch(model, 2))
    with pytest.raises(jcas.ActionError, match="NaN"):
        evaluate(lambda rows: np.full((*rows.shape[:-1], 2), np.nan, np.float32), model, episodes=2)


def test_wilson_intervals_equal_published_ones():
    # R: prop.test(x, n, correct = FALSE)$conf.int
    assert wilson(5, 10) == pytest.approx((0.5, 0.23659309051256406, 0.7634069094874359))
    assert wilson(0, 10) == pytest.approx((0.0, 0.0, 0.2775327998628893))
    assert wilson(10, 10) == pytest.approx((1.0, 0.7224672001101107, 1.0))


def test_bootstrap_intervals_are_near_those_of_the_central_limit():
    rows = np.arange(400, dtype=np.float64)[:, None] % 20
    mean, low, high = bootstrap_means(rows)
    half = 1.96 * (399 / 12 / 400) ** 0.5
    assert (
        mean[0] == 9.5
        and low[0] == pytest.approx(9.5 - half, abs=0.1)
        and high[0] == pytest.approx(9.5 + half, abs=0.1)
    )


def test_a_report_counts_what_single_missions_give():
    model = jcas.Model(
        uav_count=4, hotspot_count=1, quorum=1, radar_cross_section_dbsm=10, horizon_steps=30
    )
    policy = jcas.Policy.baseline("random", model, pilot="mid")
    report = evaluate(policy, model, episodes=40, seed=7, policy="random", threads=2)
    steps, successes, returns = [], 0, []
    for k in range(40):
        sim = jcas.Sim(model, jcas.model.derive_seed(7, k))
        while not (sim.terminated or sim.truncated):
            sim.step(policy.act(sim))
        metrics = sim.metrics()
        successes += metrics["terminated"]
        steps.append(metrics["steps"] if metrics["terminated"] else 30)
        returns.append(metrics["return_sum"])
    assert 0 < successes < 40
    assert report["success_rate"].value == successes / 40
    assert report["mission_steps_mean"].value == pytest.approx(np.mean(steps))
    assert report["return_mean"].value == pytest.approx(np.mean(returns))
    assert report["return_mean"].low < report["return_mean"].value < report["return_mean"].high
    assert "success rate" in str(report) and report.to_dict()["episodes"] == 40


def test_a_function_of_observations_is_evaluated_as_a_policy():
    model = jcas.Model(uav_count=4, hotspot_count=1, quorum=1, horizon_steps=20)
    report = evaluate(
        lambda rows: np.full((*rows.shape[:-1], 2), 0.8, np.float32), model, episodes=3
    )
    assert report["pilot_density_mean"].value == pytest.approx(0.271)


def test_the_command_flies_a_policy_that_was_written_here(tmp_path):
    command = os.environ.get("JCAS_COMMAND")
    if command is None:
        pytest.skip("JCAS_COMMAND names no jcas command")
    pytest.importorskip("safetensors")
    model = jcas.Model(uav_count=4, hotspot_count=2)
    policy = made(model)
    policy.save(tmp_path / "mine", "mine", model.config, {"trainer": "another", "seed": 3})
    told = subprocess.run(
        [command, "evaluate", tmp_path / "mine", "--episodes", "40", "--json"],
        check=True, capture_output=True, text=True,
    ).stdout  # fmt: skip
    flown = jcas.Policy.load(tmp_path / "mine", model)
    theirs, ours = json.loads(told), evaluate(flown, model, episodes=40, seed=1).to_dict()
    for name in ("mission_steps_mean", "energy_kwh_mean", "return_mean"):
        assert ours[name] == pytest.approx(theirs[name], rel=1e-12), name


SHIPPED = Path(__file__).parents[2] / "policies" / "mission"


def test_the_example_flies_the_shipped_policy(tmp_path):
    pytest.importorskip("PIL")
    example = Path(__file__).parents[2] / "examples" / "fly_policy.py"
    options = [
        "--uavs",
        "15",
        "--hotspots",
        "7",
        "--episodes",
        "4",
        "--picture",
        tmp_path / "end.png",
    ]
    told = subprocess.run(
        [sys.executable, example, SHIPPED, *options], check=True, capture_output=True, text=True
    )
    assert "15 UAVs, 7 hotspots" in told.stdout and (tmp_path / "end.png").stat().st_size > 10_000


def test_the_shipped_policy_flies_here_as_from_the_command():
    command = os.environ.get("JCAS_COMMAND")
    if command is None:
        pytest.skip("JCAS_COMMAND names no jcas command")
    model = jcas.Model(jcas.trained_on(SHIPPED), uav_count=15, hotspot_count=7)
    ours = evaluate(jcas.Policy.load(SHIPPED, model), model, episodes=40, seed=1).to_dict()
    evaluation = [
        command,
        "evaluate",
        SHIPPED,
        "--uavs=15",
        "--hotspots=7",
        "--episodes=40",
        "--seed=1",
        "--json",
    ]
    theirs = json.loads(
        subprocess.run(evaluation, check=True, capture_output=True, text=True).stdout
    )
    for name in ("success_rate", "success_rate_low", "success_rate_high"):
        assert ours[name] == pytest.approx(theirs[name], rel=1e-12), name
    for name in ("mission_steps_mean", "energy_kwh_mean", "return_mean"):
        assert ours[name] == pytest.approx(theirs[name], rel=1e-12), name
        # The ends follow from two sets of 2000 resamples, so they differ by a part of the width.
        width = theirs[f"{name}_high"] - theirs[f"{name}_low"]
        for end in ("low", "high"):
            ours_end, theirs_end = ours[f"{name}_{end}"], theirs[f"{name}_{end}"]
            assert ours_end == pytest.approx(theirs_end, abs=0.1 * width), (name, end)


@pytest.mark.parametrize(
    ("text", "message"),
    [("{", "not JSON"), ("[]", "format"), ('{"format": 9}', "format"), ('{"format": 1}', "config")],
)
def test_damaged_cards_are_refused(tmp_path, text, message):
    (tmp_path / "policy.json").write_text(text)
    with pytest.raises(jcas.PolicyError, match=message):
        jcas.trained_on(tmp_path)
