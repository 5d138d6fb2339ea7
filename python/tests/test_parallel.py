"""The PettingZoo environment against PettingZoo's own tests, and over whole episodes."""

import inspect
import warnings

import numpy as np
import pytest
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, render_test
from pettingzoo.test.max_cycles_test import max_cycles_test

import jcas

KINDS = ("box", "dict", "tuple", "discrete")


def sampled_episode(env, seed, steps=200):
    """Fly with sampled actions; everything that came out, step by step."""
    observations, _ = env.reset(seed=seed)
    for place, agent in enumerate(env.possible_agents):
        env.action_space(agent).seed(1000 + place)
    record = [np.stack(list(observations.values()))]
    for _ in range(steps):
        if not env.agents:
            break
        observations, rewards, terminated, truncated, _ = env.step(
            {agent: env.action_space(agent).sample() for agent in env.agents}
        )
        record.append(np.stack(list(observations.values())))
        record.append(
            np.array(
                [*rewards.values(), *terminated.values(), *truncated.values()], dtype=np.float64
            )
        )
    return record


@pytest.mark.parametrize("kind", KINDS)
def test_pettingzoo_accepts_the_parallel_form(kind):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(jcas.parallel_env(action_space=kind, uav_count=4), num_cycles=500)
        parallel_seed_test(
            lambda: jcas.parallel_env(action_space=kind, uav_count=4), num_cycles=500
        )


def test_pettingzoo_accepts_the_turn_based_form():
    api_test(jcas.env(uav_count=3, horizon_steps=20), num_cycles=200)


def test_max_cycles():
    # Targets too faint to find: no episode ends before its horizon.
    class Module:
        parallel_env = staticmethod(
            lambda **options: jcas.parallel_env(radar_cross_section_dbsm=-90, **options)
        )
        env = staticmethod(lambda **options: jcas.env(radar_cross_section_dbsm=-90, **options))

    max_cycles_test(Module)


def test_rendering_in_every_mode():
    pytest.importorskip("PIL")
    pytest.importorskip("pygame")
    render_test(jcas.env)


@pytest.mark.parametrize("kind", KINDS)
def test_equal_seeds_give_equal_episodes_and_different_seeds_do_not(kind):
    make = lambda: jcas.parallel_env(action_space=kind, uav_count=5)  # noqa: E731
    first, second, third = (sampled_episode(make(), seed) for seed in (7, 7, 8))
    assert len(first) == len(second) > 100
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))
    assert not np.array_equal(first[0], third[0])


def test_episodes_without_a_seed_differ_and_follow_the_last_seed():
    one, two = jcas.parallel_env(), jcas.parallel_env()
    starts = []
    for env in (one, two):
        env.reset(seed=3)
        starts.append([env.reset()[0]["uav_0"] for _ in range(3)])
    assert all(np.array_equal(a, b) for a, b in zip(*starts, strict=True))
    assert not np.array_equal(starts[0][0], starts[0][1])
    assert not np.array_equal(
        jcas.parallel_env().reset()[0]["uav_0"], jcas.parallel_env().reset()[0]["uav_0"]
    )


def test_observations_and_state_lie_in_their_spaces_to_the_end():
    env = jcas.parallel_env(
        uav_count=6, quorum=1, radar_cross_section_dbsm=30, battery_capacity_kwh=0.05
    )
    observations, _ = env.reset(seed=2)
    while env.agents:
        assert all(
            env.observation_space(agent).contains(row) for agent, row in observations.items()
        )
        assert env.state_space.contains(env.state())
        observations, *_ = env.step(
            {agent: env.action_space(agent).sample() for agent in env.agents}
        )


def test_infos_hold_reward_components_and_at_the_end_metrics():
    env = jcas.parallel_env(uav_count=4, horizon_steps=12)
    env.reset(seed=5)
    returned, info = 0.0, {}
    while env.agents:
        _, rewards, terminated, truncated, infos = env.step(
            {agent: env.action_space(agent).sample() for agent in env.agents}
        )
        info = infos["uav_1"]
        assert info["reward_components"].shape == (len(jcas.REWARD_NAMES),)
        assert sum(info["reward_components"].tolist()) == rewards["uav_1"]
        assert len(set(rewards.values())) == 1
        returned += rewards["uav_1"]
        assert (info["steps"] > 0) == (terminated["uav_1"] or truncated["uav_1"])
    assert info["steps"] == 12 and info["success"] is False
    assert info["return_sum"] == pytest.approx(returned, rel=1e-12)


def test_success_terminates_and_does_not_truncate():
    env = jcas.parallel_env(
        uav_count=3,
        hotspot_count=1,
        quorum=1,
        grid_width=3,
        grid_height=3,
        radar_cross_section_dbsm=60,
    )
    env.reset(seed=1)
    _, _, terminated, truncated, _ = env.step(
        {agent: np.array([0.8, 1.0], np.float32) for agent in env.agents}
    )
    assert all(terminated.values()) and not any(truncated.values()) and env.agents == []


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (np.array([np.nan, 0], np.float32), r"actions\[1\]\[0\] = NaN"),
        (np.zeros(3, np.float32), r"uav_1.*\(3,\).*\(2,\)"),
        (None, "no action for uav_1"),
    ],
)
def test_refused_actions_leave_the_state_as_it_was(action, message):
    env = jcas.parallel_env(uav_count=3)
    env.reset(seed=1)
    before = env.save()
    actions = {agent: np.zeros(2, np.float32) for agent in env.agents}
    if action is None:
        del actions["uav_1"]
    else:
        actions["uav_1"] = action
    with pytest.raises(jcas.ActionError, match=message):
        env.step(actions)
    assert env.save() == before


def test_a_step_after_the_end_is_refused():
    env = jcas.parallel_env(uav_count=2, quorum=1, max_cycles=1)
    env.reset(seed=1)
    actions = {agent: np.zeros(2, np.float32) for agent in env.agents}
    env.step(actions)
    with pytest.raises(jcas.EpisodeOverError, match="reset"):
        env.step(actions)


@pytest.mark.parametrize(
    ("motion_map", "bins"), [("udlrs", (0, 1, 2, 3, 4)), ("symmetric", (0, 4, 1, 3, 2))]
)
def test_hybrid_actions_mean_the_same_as_box_actions(motion_map, bins):
    states = []
    for kind in ("box", "dict", "tuple"):
        env = jcas.parallel_env(action_space=kind, uav_count=5, motion_map=motion_map)
        env.reset(seed=9)
        for motion in (0, 1, 2, 3, 4, 0, 0):
            pilot = np.array([0.25], np.float32)
            action = {
                "box": np.array([-0.8 + 0.4 * bins[motion], 0.25], np.float32),
                "dict": {"motion": motion, "pilot": pilot},
                "tuple": (motion, pilot),
            }[kind]
            env.step(dict.fromkeys(env.agents, action))
        states.append(env.save())
    assert states[0] == states[1] == states[2]
    cells = env.sim.cells()
    assert (cells == [6, 8]).all()


def test_the_functions_are_documented_and_typed():
    for function in (jcas.parallel_env, jcas.env, jcas.make_vec):
        assert inspect.getdoc(function)
        assert inspect.signature(function).return_annotation is not inspect.Signature.empty
