"""Plans: made, read, refused, and flown."""

import json
import pickle

import numpy as np
import pytest

import jcas
from jcas.evaluation import evaluate


def search_model(**fields):
    return jcas.Model("search", grid_width=8, grid_height=8, uav_count=5, hotspot_count=2, **fields)


@pytest.fixture(scope="module")
def plan():
    return jcas.Plan.search(search_model(), iterations=5_000, seed=3)


def test_trajectories_begin_at_the_depot_and_step_to_neighbours(plan):
    config = plan.model.config
    steps = plan.pilot_densities.shape[1]
    assert plan.cells.shape == (5, steps + 1, 2) and plan.pilot_densities.shape == (5, steps)
    assert (plan.cells[:, 0] == plan.model.depots()[0]).all()
    assert np.abs(np.diff(plan.cells.astype(int), axis=1)).sum(axis=2).max() == 1
    assert plan.cells.max() < 8
    assert plan.pilot_densities.min() >= config["pilot_density_min"]
    assert plan.pilot_densities.max() <= config["pilot_density_max"]
    assert 0 < plan.bound_steps <= plan.expected_steps <= plan.start_steps
    assert plan.expected_confirmed_steps <= plan.expected_steps and 0 < plan.success <= 1
    assert (plan.iterations, plan.seed, plan.stopped) == (5_000, 3, False)
    with pytest.raises(ValueError, match="read-only"):
        plan.cells[0, 0, 0] = 1


def test_missions_take_the_time_that_is_expected(plan):
    policy = jcas.Policy.follow(plan)
    report = evaluate(policy, plan.model, episodes=1500, seed=5)
    flown = report["mission_steps_mean"]
    # The interval holds in 95 of 100 cases; twice its width is left for the others.
    width = flown.high - flown.low
    assert flown.low - width / 2 < plan.expected_steps < flown.high + width / 2


def test_a_plan_depends_on_its_seed_and_moves_alone(plan):
    same = jcas.Plan.search(search_model(), iterations=5_000, seed=3)
    other = jcas.Plan.search(search_model(), iterations=5_000, seed=4)
    assert same.to_json() == plan.to_json() != other.to_json()


def test_a_plan_survives_its_text_and_pickle(plan):
    text = plan.to_json()
    assert json.loads(text)["uavs"][2]["cells"] == plan.cells[2].tolist()
    for again in (
        jcas.Plan.from_json(text, plan.model),
        jcas.Plan.from_json(text.encode(), plan.model),
        pickle.loads(pickle.dumps(plan)),
    ):
        assert again.to_json() == text
        assert again.expected_steps == plan.expected_steps
    assert "at least" in repr(plan)


def test_a_tour_confirms_known_hotspots():
    model = jcas.Model("paper", uav_count=8, hotspot_count=3)
    sim = jcas.Sim(model, 2)
    tour = jcas.Plan.tour(model, sim.hotspot_cells(), iterations=2_000)
    policy = pickle.loads(pickle.dumps(jcas.Policy.follow(tour)))
    while not (sim.terminated or sim.truncated):
        sim.step(policy.act(sim))
    assert sim.confirmed().all()


def test_progress_is_told_and_ends_the_annealing(plan):
    told = []
    stopped = jcas.Plan.search(
        plan.model,
        iterations=100_000,
        progress=lambda tried, best: told.append((tried, best)) or len(told) < 3,
    )
    assert stopped.stopped and stopped.iterations == told[-1][0] and len(told) == 3
    assert told[0][1] >= told[1][1] >= told[2][1] > 0

    def fail(tried, best):
        raise KeyError(tried)

    with pytest.raises(KeyError, match="256"):
        jcas.Plan.search(plan.model, iterations=1_000, progress=fail)


@pytest.mark.parametrize("name", ["plan", "replan"])
def test_baselines_plan_by_themselves(name):
    model = jcas.Model("paper", uav_count=6, hotspot_count=2)
    sim, policy = jcas.Sim(model, 3), jcas.Policy.baseline(name, model)
    while not (sim.terminated or sim.truncated):
        sim.step(policy.act(sim))
    assert sim.confirmed().all()


def test_wrong_calls_are_refused(plan):
    model = plan.model
    with pytest.raises(jcas.ArgumentError, match="iterations"):
        jcas.Plan.search(model, iterations=-1)
    with pytest.raises(jcas.ArgumentError, match="seed"):
        jcas.Plan.search(model, seed=1.5)
    with pytest.raises(jcas.ArgumentError, match="model"):
        jcas.Plan.search("search")
    with pytest.raises(jcas.ArgumentError, match="at most 128"):
        jcas.Plan.search(jcas.Model("search", uav_count=129))
    for cells, message in (
        ([[0, 1]], r"shape \(1, 2\)"),
        ([[0, 1], [2.0, 3]], "float64"),
        ([[0, 1], [-1, 3]], "cells of the grid"),
        ([[0, 1], [8, 3]], "off the grid"),
    ):
        with pytest.raises(jcas.ArgumentError, match=message):
            jcas.Plan.tour(model, cells)
    with pytest.raises(jcas.PlanError, match="no plan"):
        jcas.Plan.from_json(plan.to_json()[:-1], model)
    with pytest.raises(jcas.PlanError, match="configuration"):
        jcas.Plan.from_json(plan.to_json(), search_model(horizon_steps=9))
    with pytest.raises(jcas.ArgumentError, match="text"):
        jcas.Plan.from_json(None, model)
    with pytest.raises(jcas.ArgumentError, match="plan"):
        jcas.Policy.follow("plan.json")
