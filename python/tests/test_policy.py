"""Policies: evaluated, saved, read, refused, and flown with a report."""

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
from jcas.heads import decode
from jcas.policy import Layer, OnnxPolicy


def made(model, head="gaussian", hidden=16, seed=0, **options):
    rng = np.random.default_rng(seed)
    outputs = {"gaussian": 4, "hybrid": 7}[head]
    widths = [model.observation_len, hidden, outputs]
    layers = [
        Layer(rng.normal(0, 0.5, (i, o)).astype(np.float32), rng.normal(0, 0.5, o).astype(np.float32))
        for i, o in pairwise(widths)
    ]
    return jcas.MlpPolicy(layers, head, **options)


def test_a_network_by_hand():
    # Two inputs, one hidden pair, weights as [inputs, outputs]; relu(3, -1) = (3, 0).
    layers = [
        Layer(np.array([[1, -1], [2, 0]], np.float32), np.array([0, 0], np.float32)),
        Layer(np.array([[0.25, 0.5, 0, 0], [9, 9, 9, 9]], np.float32), np.array([0, -3, 0, 0], np.float32)),
    ]
    policy = jcas.MlpPolicy(layers)
    assert policy.outputs(np.array([[1, 1]], np.float32)).tolist() == [[0.75, -1.5, 0, 0]]
    assert policy.act(np.array([1, 1], np.float32)).tolist() == [0.75, -1.0]


def test_hybrid_heads_take_the_likeliest_motion_and_the_mean_pilot():
    outputs = np.array([[0, 0, 3, 1, 0, 50, 50], [0, 9, 0, 0, 0, -50, 50]], np.float32)
    actions = decode("hybrid", outputs, None)
    np.testing.assert_allclose(actions, [[0.0, 0.0], [-0.4, 2 / 52 - 1]], atol=1e-6)
    rng = np.random.default_rng(1)
    drawn = np.stack([decode("hybrid", outputs, rng) for _ in range(4000)])
    weights = np.exp([0, 0, 3, 1, 0])
    shares = [(np.isclose(drawn[:, 0, 0], -0.8 + 0.4 * k, atol=1e-5)).mean() for k in range(5)]
    np.testing.assert_allclose(shares, weights / weights.sum(), atol=0.03)
    assert drawn[:, 0, 1].mean() == pytest.approx(0, abs=0.02)


def test_gaussian_samples_have_the_deviation_of_the_head():
    outputs = np.tile(np.array([0.1, -0.1, -1.5, -9.0], np.float32), (20000, 1))
    drawn = decode("gaussian", outputs, np.random.default_rng(2))
    assert drawn[:, 0].std() == pytest.approx(np.exp(-1.5), rel=0.02)
    assert drawn[:, 1].std() == pytest.approx(np.exp(-2.3), rel=0.02)


@pytest.mark.parametrize("head", ["gaussian", "hybrid"])
def test_saved_policies_come_back(tmp_path, head):
    pytest.importorskip("safetensors")
    model = jcas.Model(uav_count=4)
    inputs = (np.full(model.observation_len, 0.5, np.float32), np.full(model.observation_len, 2, np.float32))
    policy = made(model, head, inputs=inputs)
    policy.save(tmp_path / "p", "test", model.config, {"seed": 3})
    back = jcas.load_policy(tmp_path / "p")
    observations = np.random.default_rng(0).normal(0, 30, (5, 4, model.observation_len)).astype(np.float32)
    assert np.array_equal(back.act(observations), policy.act(observations))
    assert back.config == model.config and (back.head, back.observation_len) == (head, model.observation_len)
    assert json.loads((tmp_path / "p" / "policy.json").read_text())["seed"] == 3
    assert sorted(os.listdir(tmp_path / "p")) == ["policy.json", "policy.safetensors"]


def test_policies_that_do_not_fit_are_refused(tmp_path):
    pytest.importorskip("safetensors")
    model = jcas.Model(uav_count=4)
    policy = made(model)
    with pytest.raises(jcas.PolicyError, match="length 40.*length 43.*5 UAVs"):
        policy.for_model(jcas.Model(uav_count=5))
    with pytest.raises(jcas.PolicyError, match="must have 7"):
        jcas.MlpPolicy(policy.layers, "hybrid")
    with pytest.raises(jcas.PolicyError, match="do not follow"):
        jcas.MlpPolicy(policy.layers[::-1])
    with pytest.raises(jcas.PolicyError, match="rng"):
        policy.act(np.zeros((1, 40), np.float32), deterministic=False)
    policy.save(tmp_path, "test", model.config, {})
    (tmp_path / "policy.safetensors").write_bytes(b"nothing")
    with pytest.raises(jcas.PolicyError, match="safetensors"):
        jcas.load_policy(tmp_path)


def test_a_held_pilot_density_is_held():
    model = jcas.Model(uav_count=4)
    policy = made(model, constant_pilot=0.25)
    assert (policy.act(np.zeros((3, model.observation_len), np.float32))[:, 1] == 0.25).all()


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
    model = jcas.Model(uav_count=4, hotspot_count=1, quorum=1, radar_cross_section_dbsm=10, horizon_steps=30)
    policy = made(model, "hybrid", seed=5)
    report = evaluate(policy.act, model, episodes=40, seed=7, policy="random network", threads=2)
    steps, successes, returns = [], 0, []
    for k in range(40):
        sim = jcas.Sim(model, jcas.model.derive_seed(7, k))
        while not (sim.terminated or sim.truncated):
            sim.step(policy.act(sim.observe()))
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


@pytest.mark.parametrize("network", ["mlp", "set"])
def test_policies_of_the_command_line_fly_the_same_here(tmp_path, network):
    """Weights and ONNX agree, and a report here is the command's on the same missions."""
    command = os.environ.get("JCAS_COMMAND")
    if command is None:
        pytest.skip("JCAS_COMMAND names no jcas command")
    pytest.importorskip("safetensors")
    pytest.importorskip("onnxruntime")
    settings = {
        "network": network, "actor_hidden": [32, 32], "critic_hidden": [32, 32], "environments": 20,
        "batch_steps": 500, "critic_minibatch_rows": 500, "evaluation_episodes": 10,
    }  # fmt: skip
    chosen = [f"--train-set={name}={value}" for name, value in settings.items()]
    out = tmp_path / "run"
    train = [command, "train", "--uavs", "4", "--hotspots", "2", "--steps", "1000", "--out", out, *chosen]
    subprocess.run(train, check=True, capture_output=True)
    policy = jcas.load_policy(out)
    model = jcas.Model(policy.config)
    policy.for_model(model)
    observations = np.stack([jcas.Sim(model, seed).observe() for seed in range(20)])
    graph = OnnxPolicy(out / "policy.onnx", policy.head)
    np.testing.assert_allclose(policy.act(observations), graph.act(observations), atol=1e-5)

    report = evaluate(policy.act, model, episodes=60, seed=5).to_dict()
    evaluation = [command, "evaluate", out, "--episodes", "60", "--seed", "5", "--mode", "deterministic", "--json"]
    theirs = json.loads(subprocess.run(evaluation, check=True, capture_output=True, text=True).stdout)
    # Networks differ in the last bits of a sum, which moves a pilot density by as much.
    for name in ("success_rate", "mission_steps_mean", "energy_kwh_mean", "return_mean", "confirmed_mean"):
        assert report[name] == pytest.approx(theirs[name], rel=1e-4), name
    assert set(report) - {"policy"} == set(theirs) - {"policy", "pilot"}
    assert report["config_hash"] == theirs["config_hash"]


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
    theirs, ours = json.loads(told), evaluate(policy.act, model, episodes=40, seed=1).to_dict()
    for name in ("mission_steps_mean", "energy_kwh_mean", "return_mean"):
        assert ours[name] == pytest.approx(theirs[name], rel=1e-4), name


SHIPPED = Path(__file__).parents[2] / "policies" / "fleet"


def test_the_shipped_policy_gives_what_its_graph_gives():
    pytest.importorskip("safetensors")
    pytest.importorskip("onnxruntime")
    policy = jcas.load_policy(SHIPPED)
    sim = jcas.Sim(jcas.Model(policy.config), 3)
    graph = OnnxPolicy(SHIPPED / "policy.onnx", policy.head)
    rng = np.random.default_rng(0)
    for _ in range(20):
        rows = sim.observe()
        np.testing.assert_allclose(policy.act(rows), graph.act(rows), atol=1e-5)
        sim.step(rng.uniform(-1, 1, (5, 2)))
    stacked = np.stack([rows, rows[::-1]])
    np.testing.assert_allclose(policy.act(stacked)[1], policy.act(rows)[::-1], atol=1e-6)


@pytest.mark.parametrize(("uavs", "hotspots"), [(15, 7), (4, 1)])
def test_the_shipped_policy_flies_any_fleet(uavs, hotspots):
    """A random fleet, which is what a mixed-up network comes to, never succeeds here."""
    pytest.importorskip("safetensors")
    policy = jcas.load_policy(SHIPPED)
    model = jcas.Model(policy.config, uav_count=uavs, hotspot_count=hotspots)
    with pytest.raises(jcas.PolicyError, match="for_model"):
        policy.act(jcas.Sim(model).observe())
    report = evaluate(policy.for_model(model).act, model, episodes=20)
    assert report["success_rate"].value > 0.5


@pytest.mark.parametrize(("width", "height"), [(1, 9), (9, 1)])
def test_a_grid_of_one_column_gives_the_numbers_that_the_library_gives(width, height):
    pytest.importorskip("safetensors")
    model = jcas.Model(uav_count=4, hotspot_count=2, grid_width=width, grid_height=height)
    policy = jcas.load_policy(SHIPPED).for_model(model)
    library = jcas.Policy.load(SHIPPED, model, mode="deterministic")
    sim = jcas.Sim(model, 2)
    for _ in range(5):
        actions = library.act(sim)
        np.testing.assert_allclose(policy.act(sim.observe()), actions, atol=1e-4)
        sim.step(actions)


def test_the_example_flies_the_shipped_policy(tmp_path):
    pytest.importorskip("safetensors")
    pytest.importorskip("PIL")
    example = Path(__file__).parents[2] / "examples" / "fly_policy.py"
    options = ["--uavs", "15", "--hotspots", "7", "--episodes", "4", "--picture", tmp_path / "end.png"]
    told = subprocess.run([sys.executable, example, SHIPPED, *options], check=True, capture_output=True, text=True)
    assert "15 UAVs, 7 hotspots" in told.stdout and (tmp_path / "end.png").stat().st_size > 10_000


def test_the_shipped_policy_flies_here_as_from_the_command():
    command = os.environ.get("JCAS_COMMAND")
    if command is None:
        pytest.skip("JCAS_COMMAND names no jcas command")
    pytest.importorskip("safetensors")
    policy = jcas.load_policy(SHIPPED)
    model = jcas.Model(policy.config, uav_count=15, hotspot_count=7)
    ours = evaluate(policy.for_model(model).act, model, episodes=40, seed=1).to_dict()
    evaluation = [command, "evaluate", SHIPPED, "--uavs=15", "--hotspots=7", "--episodes=40", "--seed=1", "--json"]
    theirs = json.loads(subprocess.run(evaluation, check=True, capture_output=True, text=True).stdout)
    for name in ("success_rate", "mission_steps_mean", "energy_kwh_mean", "return_mean"):
        assert ours[name] == pytest.approx(theirs[name], rel=1e-3), name


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda card: card.update(format=9), "format"),
        (lambda card: card.pop("head"), "head"),
        (lambda card: card["architecture"].update(kind="forest"), "forest"),
        (lambda card: card.update(head="gaussian"), "gaussian"),
    ],
)
def test_damaged_cards_are_refused(tmp_path, change, message):
    pytest.importorskip("safetensors")
    (tmp_path / "policy.safetensors").write_bytes((SHIPPED / "policy.safetensors").read_bytes())
    card = json.loads((SHIPPED / "policy.json").read_text())
    change(card)
    (tmp_path / "policy.json").write_text(json.dumps(card))
    with pytest.raises(jcas.PolicyError, match=message):
        jcas.load_policy(tmp_path)
