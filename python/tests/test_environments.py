"""Tests of every environment: seeds, order of calls, snapshots, forks, pickling and `repr`."""

import contextlib
import inspect
import io
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import jcas

FIELDS = {"uav_count": 3, "hotspot_count": 2, "horizon_steps": 12}


class Parallel:
    """Drives every kind of environment by one interface."""

    make = staticmethod(lambda **options: jcas.parallel_env(**FIELDS, **options))

    @staticmethod
    def step(env, actions):
        env.step(dict(zip(env.possible_agents, actions, strict=True)))

    state = staticmethod(lambda env: env.sim.state_hash())


class Turns(Parallel):
    make = staticmethod(lambda **options: jcas.env(**FIELDS, **options))

    @staticmethod
    def step(env, actions):
        for action in actions:
            env.step(action)


class Fleet(Parallel):
    make = staticmethod(lambda **options: jcas.FleetEnv(**FIELDS, **options))
    step = staticmethod(lambda env, actions: env.step(actions))


class Vector(Parallel):
    make = staticmethod(lambda **options: jcas.make_vec(num_envs=2, **FIELDS, **options))
    step = staticmethod(lambda env, actions: env.step(np.stack([actions, actions])))
    state = staticmethod(lambda env: [env.batch.member(member).state_hash() for member in range(2)])


KINDS = pytest.mark.parametrize(
    "kind", [Parallel, Turns, Fleet, Vector], ids=lambda kind: kind.__name__
)


def actions(step):
    return np.random.default_rng(step).uniform(-1, 1, (3, 2)).astype(np.float32)


def flown(kind, seed=5, steps=4):
    env = kind.make()
    env.reset(seed=seed)
    for step in range(steps):
        kind.step(env, actions(step))
    return env


@KINDS
def test_seeds_of_every_integer_type_mean_the_same(kind):
    states = []
    for seed in (4, np.int64(4), np.uint8(4)):
        env = kind.make()
        env.reset(seed=seed)
        states.append(kind.state(env))
        env.reset()
        states.append(kind.state(env))
    assert states[0:2] == states[2:4] == states[4:6] and states[0] != states[1]
    env.reset(seed=2**64 - 1)
    highest = kind.state(env)
    env.reset(seed=0)
    assert kind.state(env) != highest
    for bad in (-1, 2**64, 1.0, "4", True):
        with pytest.raises(jcas.ArgumentError, match="seed"):
            env.reset(seed=bad)


@KINDS
def test_nothing_flies_before_the_first_reset(kind):
    env = kind.make(render_mode="rgb_array")
    for ask in (lambda: kind.step(env, actions(0)), env.save, env.render):
        with pytest.raises((jcas.ResetNeededError, AssertionError, AttributeError), match="reset"):
            ask()
    env.fork().reset(seed=1)


@KINDS
def test_a_saved_state_comes_back(kind):
    env = flown(kind)
    saved, state = env.save(), kind.state(env)
    kind.step(env, actions(9))
    after = kind.state(env)
    assert after != state
    for other in (env, kind.make(), pickle.loads(pickle.dumps(kind.make()))):
        other.load(saved)
        assert kind.state(other) == state and other.save() == saved
        kind.step(other, actions(9))
        assert kind.state(other) == after
    with pytest.raises(jcas.JcasError):
        env.load(saved[:-1])
    assert kind.state(env) == after


@KINDS
@pytest.mark.parametrize(
    "twin_of", [lambda env: env.fork(), lambda env: pickle.loads(pickle.dumps(env))]
)
def test_twins_go_their_own_way_and_meet_the_same_episodes(kind, twin_of):
    env = flown(kind)
    twin = twin_of(env)
    before = kind.state(env)
    assert kind.state(twin) == before
    kind.step(twin, actions(9))
    assert kind.state(env) == before != kind.state(twin)
    kind.step(env, actions(9))
    assert kind.state(env) == kind.state(twin)
    env.reset()
    twin.reset()
    assert kind.state(env) == kind.state(twin)
    if kind is not Turns:
        assert env.reset()[0] is not twin.reset()[0]


@KINDS
def test_environments_say_what_they_are(kind):
    env = kind.make()
    assert "3 UAVs, 2 hotspots" in repr(env)
    env.reset(seed=1)
    assert repr(env).startswith("<jcas.") and repr(env) != object.__repr__(env)


def test_snapshots_travel_between_environments_of_one_mission():
    saved = flown(Parallel).save()
    for env in (jcas.FleetEnv(**FIELDS), jcas.env(**FIELDS), jcas.parallel_env(**FIELDS)):
        env.reset(seed=1, options={"snapshot": saved})
        assert env.save() == saved
    sim = jcas.Sim(jcas.Model(**FIELDS))
    sim.load(bytearray(saved))
    assert sim.save() == saved and "step 4 of 12" in repr(sim)


def test_turns_are_saved_between_rounds_only_and_forked_anywhere():
    env = flown(Turns)
    env.step(actions(9)[0])
    with pytest.raises(jcas.SnapshotError, match="uav_1"):
        env.save()
    twin = env.fork()
    for action in actions(9)[1:]:
        env.step(action)
        twin.step(action)
    assert env.save() == twin.save() and env.rewards == twin.rewards
    done = flown(Parallel, steps=12)
    assert not done.agents
    with pytest.raises(jcas.SnapshotError, match="ended"):
        env.load(done.save())


def test_a_vector_environment_is_pickled_with_its_ended_missions():
    env = flown(Vector, steps=12)
    twin = pickle.loads(pickle.dumps(env))
    for step in range(3):
        both = [each.step(np.stack([actions(step)] * 2)) for each in (env, twin)]
        assert all(np.array_equal(a, b) for a, b in zip(both[0][:4], both[1][:4], strict=True))
    buffers = jcas.BatchBuffers(env.model, 2)
    env.batch.observe(buffers)
    copied = pickle.loads(pickle.dumps(buffers))
    assert np.array_equal(copied.observations, buffers.observations)
    env.batch.observe(copied)
    assert not np.shares_memory(copied.observations, buffers.observations)


def test_a_batch_takes_what_numpy_users_give():
    model = jcas.Model(**FIELDS)
    wanted = np.random.default_rng(0).uniform(-1, 1, (2, 3, 2)).astype(np.float32)
    odd = np.zeros(wanted.size * 4 + 1, np.uint8)[1:].view(np.float32).reshape(wanted.shape)
    odd[:] = wanted
    assert not odd.flags.aligned
    forms = [
        wanted, wanted.astype(np.float64), wanted.tolist(), np.asfortranarray(wanted),
        wanted[::-1].copy()[::-1],
        wanted.astype(">f4"), odd, np.repeat(wanted, 2, axis=1)[:, ::2],
    ]  # fmt: skip
    hashes = []
    for form in forms:
        batch, buffers = jcas.Batch(model, 2), jcas.BatchBuffers(model, 2)
        batch.reset(np.array([3, 4], np.int64), buffers)
        batch.step(form, buffers)
        hashes.append([batch.member(0).state_hash(), batch.member(1).state_hash()])
    assert all(each == hashes[0] for each in hashes)
    batch.step(np.broadcast_to(np.float64(0.5), wanted.shape), buffers)


def test_agents_infos_are_their_own():
    env = jcas.parallel_env(**FIELDS)
    env.reset(seed=1)
    while env.agents:
        infos = env.step(dict.fromkeys(env.agents, np.zeros(2)))[-1]
    infos["uav_0"]["steps"] = infos["uav_0"]["reward_components"][0] = -1
    assert infos["uav_1"]["steps"] == 12 and infos["uav_1"]["reward_components"][0] >= 0


def test_after_the_end_nothing_happens_without_actions():
    env = flown(Parallel, steps=12)
    assert not env.agents and env.step({}) == ({}, {}, {}, {}, {})
    with pytest.raises(jcas.EpisodeOverError):
        env.step(dict.fromkeys(env.possible_agents, np.zeros(2)))


@pytest.mark.parametrize(
    "make", [jcas.Config, jcas.Model, jcas.parallel_env, jcas.env, jcas.FleetEnv, jcas.make_vec]
)
def test_help_lists_the_fields(make):
    keywords = inspect.signature(make).parameters
    assert {field["name"] for field in jcas.Config.fields()} <= set(keywords)
    assert "**fields" not in str(inspect.signature(make))
    with contextlib.redirect_stdout(io.StringIO()) as text:
        help(make)
    assert "uav_count: " in text.getvalue() and "preset" in text.getvalue()


def test_the_fields_are_fresh():
    generator = Path(__file__).parents[1] / "generate_fields.py"
    subprocess.run([sys.executable, generator, "--check"], check=True)


def test_type_checkers_know_fields_and_simulations(tmp_path):
    pytest.importorskip("mypy")
    program = tmp_path / "program.py"
    program.write_text(
        "import jcas\n"
        "env = jcas.parallel_env(uav_count=3, target_visibility='hidden', max_cycles=5)\n"
        "reveal_type(env.sim)\n"
        "reveal_type(jcas.FleetEnv().model)\n"
        "reveal_type(jcas.env().fork())\n"
        "jcas.make_vec(num_envs=2, uav_cuont=3)\n"
        "jcas.FleetEnv(uav_count='three')\n"
        "jcas.Model(inform_payment='twice')\n"
    )
    config = Path(__file__).parents[1] / "pyproject.toml"
    said = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", config, "--cache-dir", tmp_path / "cache",
        program],
        capture_output=True, text=True,
    ).stdout  # fmt: skip
    lines = said.splitlines()
    for line, words in ((3, "jcas.sim.Sim"), (4, "jcas.model.Model"), (5, "jcas.parallel.JcasEnv")):
        assert any(f"program.py:{line}: note" in told and words in told for told in lines), said
    for line in (6, 7, 8):
        assert any(f"program.py:{line}: error" in told for told in lines), said


def test_versions_and_words():
    assert jcas.__version__.count(".") == 2
    model = jcas.Model(**FIELDS)
    batch = jcas.Batch(model, 2)
    assert "3 UAVs, 2 hotspots, 12 x 12 cells" in repr(model) and "2 missions" in repr(batch)


def test_supersuits_wrappers_fly():
    supersuit = pytest.importorskip("supersuit")
    for wrapped in (
        supersuit.black_death_v3(jcas.parallel_env(**FIELDS)),
        supersuit.frame_skip_v0(jcas.parallel_env(**FIELDS), 3),
        supersuit.frame_skip_v0(jcas.parallel_env(**FIELDS), (1, 3)),
        supersuit.frame_skip_v0(jcas.env(**FIELDS).fleet, 3),
    ):
        for _ in range(2):
            wrapped.reset(seed=3)
            steps = 0
            while wrapped.agents:
                wrapped.step(
                    {agent: wrapped.action_space(agent).sample() for agent in wrapped.agents}
                )
                steps += 1
            assert 4 <= steps <= 13
    env = supersuit.frame_skip_v0(jcas.FleetEnv(**FIELDS), 3)
    env.reset(seed=3)
    assert [env.step(env.action_space.sample())[3] for _ in range(4)] == [False, False, False, True]


def test_stable_baselines_environment_says_what_it_takes():
    pytest.importorskip("stable_baselines3")
    from jcas.sb3 import FleetVecEnv

    for name, value in (("action_space", "dict"), ("autoreset_mode", "NextStep"), ("copy", False)):
        with pytest.raises(jcas.ArgumentError, match=name):
            FleetVecEnv(missions=2, **{name: value})
    envs = FleetVecEnv(missions=2, render_mode="rgb_array", **FIELDS)
    assert envs.render_mode == "rgb_array" and envs.action_space.shape == (2,)
    envs.seed(7)
    first = envs.reset()
    assert np.array_equal(first[:3], jcas.FleetEnv(**FIELDS).reset(seed=7)[0])
    saved = envs.save()
    twin = envs.fork()
    for _ in range(12):
        rows, rewards, dones, infos = envs.step(np.zeros((6, 2), np.float32))
        assert np.array_equal(twin.step(np.zeros((6, 2), np.float32))[0], rows)
    assert dones.all() and infos[0]["TimeLimit.truncated"] and rewards.shape == (6,)
    infos[0]["steps"] = infos[0]["episode"]["l"] = -1
    assert infos[1]["steps"] == infos[1]["episode"]["l"] == 12
    assert np.array_equal(envs.load(saved), first)
    assert pickle.loads(pickle.dumps(envs)).save() == saved
    with pytest.raises(jcas.ActionError, match="actions"):
        envs.step(np.zeros((5, 2)))


def test_rllibs_environment_flies_the_episodes_of_the_others():
    pytest.importorskip("ray.rllib")
    from jcas.rllib import JcasMultiAgentEnv

    env, other = JcasMultiAgentEnv(FIELDS), jcas.parallel_env(**FIELDS)
    for seed in (5, None, np.int64(8), None):
        rows, expected = env.reset(seed=seed)[0], other.reset(seed=seed)[0]
        assert all(
            np.array_equal(rows[agent]["observation"], expected[agent]) for agent in other.agents
        )
    with pytest.raises(jcas.ResetNeededError):
        JcasMultiAgentEnv(FIELDS).step({})
    with pytest.raises(jcas.ActionError, match="uav_1"):
        env.step({"uav_0": np.zeros(2)})
    twin = env.fork()
    for _ in range(12):
        infos = env.step(dict.fromkeys(env.possible_agents, np.zeros(2)))[-1]
    infos["uav_0"]["steps"] = -1
    assert infos["uav_1"]["steps"] == 12 and env.agents == env.possible_agents
    with pytest.raises(jcas.ArgumentError, match="options"):
        env.reset(options={"snapshots": b""})
    assert twin.sim.t == 0 and np.array_equal(
        twin.reset()[0]["uav_0"]["state"], env.reset()[0]["uav_0"]["state"]
    )
    assert env.load(twin.save())["uav_0"]["state"].shape == (env.model.global_len,)


def test_an_agent_specific_critic_tells_uavs_apart():
    pytest.importorskip("ray.rllib")
    import torch

    from jcas.rllib import CentralCriticModule, Hyperparameters, JcasMultiAgentEnv, ppo_config

    env = JcasMultiAgentEnv(FIELDS)
    rows = env.reset(seed=2)[0]
    env.step(
        {agent: np.array([0.8 * uav - 0.8, 1.0]) for uav, agent in enumerate(env.possible_agents)}
    )
    rows = env._observations()
    seen = {
        name: torch.tensor(np.stack([row[name] for row in rows.values()]))
        for name in ("observation", "state")
    }
    values = {}
    for critic in ("state", "agent"):
        module = CentralCriticModule(
            observation_space=env.observation_spaces["uav_0"],
            action_space=env.action_spaces["uav_0"],
            model_config={"hidden": [16], "critic": critic},
        )
        # Row by row: a product of several may round each of them differently.
        own = [{name: column[[uav]] for name, column in seen.items()} for uav in range(len(rows))]
        values[critic] = np.array([module.compute_values({"obs": row}).item() for row in own])
    assert np.ptp(values["state"]) == 0 < np.ptp(values["agent"])
    with pytest.raises(jcas.ArgumentError, match="critic"):
        ppo_config(jcas.Config(FIELDS), Hyperparameters(critic="own"))


def test_credit_gives_each_uav_its_own_reward():
    sim = jcas.Sim(jcas.Model(**FIELDS), 5)
    own, team = (jcas.parallel_env(credit=credit, **FIELDS) for credit in ("uav", "team"))
    turns, fleet = jcas.env(credit="uav", **FIELDS), jcas.FleetEnv(credit="uav", **FIELDS)
    envs = jcas.make_vec(num_envs=2, credit="uav", **FIELDS)
    for env in (own, team, turns, fleet, envs):
        env.reset(seed=5)
    different = False
    for step in range(12):
        outcome = sim.step(actions(step))
        rewards, components = sim.uav_rewards(), sim.uav_reward_components()
        assert rewards.mean() == pytest.approx(outcome.reward, abs=1e-12)
        np.testing.assert_allclose(components.sum(axis=1), rewards, atol=1e-12)
        each = dict(zip(own.possible_agents, actions(step), strict=True))
        assert list(own.step(each)[1].values()) == rewards.tolist()
        assert set(team.step(each)[1].values()) == {outcome.reward}
        Turns.step(turns, actions(step))
        assert [turns.rewards[agent] for agent in turns.possible_agents] == rewards.tolist()
        assert fleet.step(actions(step))[4]["uav_rewards"].tolist() == rewards.tolist()
        infos = envs.step(np.stack([actions(step)] * 2))[4]
        np.testing.assert_allclose(infos["uav_rewards"][0], rewards, rtol=1e-6)
        different |= np.ptp(rewards) > 1e-6
    assert different
    assert (envs.step(np.zeros((2, 3, 2)))[4]["uav_rewards"] == 0).all()
    for make in (jcas.parallel_env, jcas.env, jcas.FleetEnv, jcas.make_vec):
        with pytest.raises(jcas.ConfigError, match="credit"):
            make(credit="mine")


def test_credit_in_stable_baselines():
    pytest.importorskip("stable_baselines3")
    from jcas.sb3 import FleetVecEnv

    envs, sims = (
        FleetVecEnv(missions=2, credit="uav", **FIELDS),
        [jcas.Sim(jcas.Model(**FIELDS), seed) for seed in (7, 8)],
    )
    envs.seed(7)
    envs.reset()
    rewards = envs.step(np.concatenate([actions(1), actions(2)]))[1]
    for member, sim in enumerate(sims):
        sim.step(actions(1 + member))
        np.testing.assert_allclose(
            rewards[3 * member : 3 * member + 3], sim.uav_rewards(), rtol=1e-6
        )


def test_credit_in_rllib():
    pytest.importorskip("ray.rllib")
    from jcas.rllib import JcasMultiAgentEnv

    env, other = (
        JcasMultiAgentEnv({**FIELDS, "credit": "uav"}),
        jcas.parallel_env(credit="uav", **FIELDS),
    )
    env.reset(seed=5)
    other.reset(seed=5)
    each = dict(zip(other.possible_agents, actions(1), strict=True))
    assert env.step(each)[1] == other.step(each)[1]
