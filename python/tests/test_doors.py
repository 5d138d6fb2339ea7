"""Doors of other libraries: registries, spawned workers, infos, seeds, masks, wrappers."""

import subprocess
import sys
import warnings
from pathlib import Path

import gymnasium
import numpy as np
import pettingzoo
import pytest
from gymnasium.vector import AsyncVectorEnv

import jcas
from jcas.model import derive_seed
from jcas.registration import PRESETS
from jcas.sim import EPISODE_INFO

FIELDS = {"uav_count": 3, "hotspot_count": 2, "horizon_steps": 6}
KEYS = {"reward_components", *EPISODE_INFO}


def make():
    return gymnasium.make("jcas:jcas/Fleet-v0", **FIELDS)


def test_each_preset_has_an_id():
    with pytest.raises(jcas.ConfigError) as refused:
        jcas.Config("none")
    assert all(preset in str(refused.value) for preset in PRESETS)
    assert str(refused.value).count("`") == 2 * len(PRESETS), refused.value
    for preset in PRESETS:
        env = gymnasium.make(f"jcas/{preset.title()}-v0", uav_count=5)
        assert env.unwrapped.model.config == jcas.Config(preset, uav_count=5)


@pytest.mark.skipif(not hasattr(pettingzoo, "make"), reason="PettingZoo before 1.27")
def test_pettingzoos_registry_has_them_too():
    env = pettingzoo.make("parallel", "jcas/Search-v0", uav_count=4, max_cycles=7)
    assert env.unwrapped.model.config == jcas.Config("search", uav_count=4, horizon_steps=7)
    turns = pettingzoo.make("aec", "jcas/Fleet-v0", uav_count=4)
    turns.reset(seed=3)
    assert turns.agent_selection == "uav_0"


def test_spawned_workers_know_the_id():
    envs = AsyncVectorEnv([make] * 2, context="spawn")
    try:
        first = envs.reset(seed=1)[0]
    finally:
        envs.close()
    assert np.array_equal(first[1], jcas.FleetEnv(**FIELDS).reset(seed=2)[0])


def test_an_unknown_keyword_is_a_type_error_too():
    with pytest.raises(TypeError, match="unexpected keyword argument 'frameskip'"):
        gymnasium.make("jcas/Fleet-v0", frameskip=1)
    with pytest.raises(jcas.UnknownFieldError, match="uav_count"):
        jcas.parallel_env(uav_cuont=3)
    with pytest.raises(jcas.ConfigError) as refused:
        jcas.Config(uav_count=0)
    assert not isinstance(refused.value, TypeError)


@pytest.mark.parametrize("kind", ["box", "discrete"])
def test_infos_are_flat_and_have_the_same_keys_at_every_step(kind):
    masked = {"action_mask"} if kind == "discrete" else set()
    fleet = jcas.FleetEnv(action_space=kind, credit="uav", **FIELDS)
    parallel = jcas.parallel_env(action_space=kind, **FIELDS)
    envs = jcas.make_vec(num_envs=2, action_space=kind, **FIELDS)
    infos = [fleet.reset(seed=1)[1]]
    own = [parallel.reset(seed=1)[1]["uav_2"]]
    many = [envs.reset(seed=1)[1]]
    for _ in range(6):
        infos.append(fleet.step(fleet.action_space.sample())[4])
        chosen = {agent: parallel.action_space(agent).sample() for agent in parallel.agents}
        own.append(parallel.step(chosen)[4]["uav_2"])
        many.append(envs.step(envs.action_space.sample())[4])
    for each, keys in ((infos, KEYS | {"uav_rewards"}), (own, KEYS), (many, KEYS)):
        for info in each:
            assert {name for name in info if not name.startswith("_")} == keys | masked
            assert not any(isinstance(value, dict) for value in info.values())
            kinds = {name: np.asarray(value).dtype.kind for name, value in info.items()}
            assert kinds == {name: np.asarray(each[0][name]).dtype.kind for name in info}
    assert [info["steps"] for info in infos] == [0] * 6 + [6]
    assert [info["steps"].tolist() for info in many] == [[0, 0]] * 6 + [[6, 6]]


def test_the_second_episode_of_a_seed_is_the_same_in_every_door():
    second = jcas.Sim(jcas.Model(**FIELDS), derive_seed(5, 0)).observe()
    fleet, parallel = jcas.FleetEnv(**FIELDS), jcas.parallel_env(**FIELDS)
    waits, goes_on = (
        jcas.make_vec(num_envs=1, autoreset_mode=mode, **FIELDS)
        for mode in ("NextStep", "SameStep")
    )
    for env in (fleet, parallel, waits, goes_on):
        env.reset(seed=5)
    assert np.array_equal(fleet.reset()[0], second)
    assert np.array_equal(np.stack(list(parallel.reset()[0].values())), second)
    still = np.zeros((1, 3, 2), np.float32)
    for _ in range(6):
        observations = goes_on.step(still)[0]
        waits.step(still)
    assert np.array_equal(observations[0], second)
    assert np.array_equal(waits.step(still)[0][0], second)
    third = jcas.Sim(jcas.Model(**FIELDS), derive_seed(derive_seed(5, 0), 0)).observe()
    for env in (waits, goes_on, fleet):
        assert np.array_equal(env.reset()[0].reshape(third.shape), third)


def test_derived_seeds_of_neighbours_share_no_episode():
    def flown(seeding, seed):
        envs = jcas.make_vec(num_envs=64, seeding=seeding, autoreset_mode="SameStep", **FIELDS)
        envs.reset(seed=seed)
        seeds = set()
        for step in range(24):
            if step % 6 == 0:
                seeds |= {envs.batch.member(member).seed for member in range(64)}
            envs.step(np.zeros(envs.action_space.shape, np.float32))
        return seeds

    assert len(flown("consecutive", 1) & flown("consecutive", 2)) == 252
    assert len(flown("derived", 1)) == 256 and not flown("derived", 1) & flown("derived", 2)


def test_masks_mark_the_actions_that_make_a_difference():
    fields = {"uav_count": 2, "quorum": 1, "hotspot_count": 1, "grid_width": 3, "grid_height": 2}
    env = jcas.FleetEnv(action_space="discrete", pilot_levels=2, horizon_steps=400, **fields)
    _, info = env.reset(seed=1)
    rng, emptied = np.random.default_rng(0), False
    for _ in range(400):
        mask = info["action_mask"].astype(bool)
        assert np.array_equal(mask.reshape(-1), env.action_masks())
        cells, soc, before = env.sim.cells(), env.sim.soc(), env.save()
        for uav in range(2):
            x, y = cells[uav]
            inside = np.array([y < 1, y > 0, x > 0, x < 2]) & (soc[uav] > 0)
            assert mask[uav].tolist() == np.repeat([*inside, True], 2).tolist()
            for action in np.flatnonzero(~mask[uav]):
                # A masked motion is the same as to stay with that density.
                ends = []
                for chosen in (action, 8 + action % 2):
                    env.load(before)
                    env.step(np.array([chosen if other == uav else 8 for other in range(2)]))
                    ends.append(env.sim.state_hash())
                assert ends[0] == ends[1]
        emptied |= bool((soc == 0).any())
        env.load(before)
        _, _, terminated, truncated, info = env.step(rng.integers(0, 10, 2))
        if terminated or truncated:
            _, info = env.reset()
    pairs = env._form.encode_fleet(np.array([0, 9]), (2, 2))
    np.testing.assert_allclose(pairs, [[-0.8, -1], [0.8, 1]], atol=1e-6)


def test_masks_of_a_batch_and_of_agents_are_those_of_a_fleet():
    envs = jcas.make_vec(num_envs=2, action_space="discrete", **FIELDS)
    parallel = jcas.parallel_env(action_space="discrete", **FIELDS)
    infos, own = envs.reset(seed=4)[1], parallel.reset(seed=4)[1]
    for _ in range(5):
        assert infos["action_mask"].shape == (2, 3, 15)
        for uav, agent in enumerate(parallel.agents):
            assert np.array_equal(own[agent]["action_mask"], infos["action_mask"][0, uav])
            assert parallel.action_space(agent).sample(own[agent]["action_mask"]) < 15
        actions = envs.action_space.sample()
        infos = envs.step(actions)[4]
        own = parallel.step(dict(zip(parallel.agents, actions[0], strict=True)))[4]


@pytest.mark.heavy
def test_value_based_and_masked_learners_start():
    pytest.importorskip("stable_baselines3")
    from stable_baselines3 import DQN

    from jcas.sb3 import FleetVecEnv

    envs = FleetVecEnv(missions=2, action_space="discrete", **FIELDS)
    DQN("MlpPolicy", envs, learning_starts=20, seed=1).learn(120)
    masked = pytest.importorskip("sb3_contrib").MaskablePPO
    for learner in (envs, jcas.FleetEnv(action_space="discrete", **FIELDS)):
        model = masked("MlpPolicy", learner, n_steps=32, batch_size=32, seed=1).learn(64)
    observation = learner.reset(seed=1)[0]
    masks = learner.action_masks()
    action, _ = model.predict(observation, action_masks=masks)
    assert masks.reshape(3, 15)[np.arange(3), action].all()


@pytest.mark.heavy
def test_torchrl_keeps_the_infos_and_makes_the_id():
    libs = pytest.importorskip("torchrl.envs")
    rollout = libs.PettingZooWrapper(jcas.parallel_env(**FIELDS)).rollout(6)
    infos = rollout["next", "uav", "info"]
    assert set(infos.keys()) == KEYS
    assert infos["steps"].reshape(6, 3).tolist() == [[0] * 3] * 5 + [[6] * 3]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        env = libs.GymEnv("jcas/Paper-v0")
    assert env.rollout(3)["observation"].shape == (
        3,
        *jcas.FleetEnv("paper").observation_space.shape,
    )
    masked = libs.PettingZooWrapper(
        jcas.parallel_env(action_space="discrete", **FIELDS), use_mask=True
    )
    assert masked.reset()["uav", "action_mask"].shape == (3, 15)


@pytest.mark.heavy
def test_minari_keeps_the_infos_of_recorded_episodes(tmp_path, monkeypatch):
    minari = pytest.importorskip("minari")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    example = Path(__file__).parents[2] / "examples" / "minari_dataset.py"
    command = [sys.executable, example, "teams", "replan", "--episodes", "2"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    for policy in ("teams", "replan"):
        data = minari.load_dataset(f"jcas/paper-{policy}-v0")
        assert data.total_episodes == 2 and f"paper-{policy}-v0: 2 episodes" in done.stdout
        for episode in data.iterate_episodes():
            steps = len(episode.actions)
            assert episode.infos["steps"].tolist() == [0] * steps + [steps]
            assert episode.terminations[-1] and episode.infos["success"][-1]
            env = data.recover_environment()
            env.reset(seed=derive_seed(1, episode.id) % 2**63)
            for action in episode.actions:
                _, _, terminated, _, _ = env.step(action)
            assert terminated
