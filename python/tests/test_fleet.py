"""The Gymnasium environments against Gymnasium's own checker, and against each other."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import jcas
from jcas.model import derive_seed
from jcas.sim import EPISODE_INFO


@pytest.mark.parametrize("kind", ["box", "dict", "tuple", "discrete"])
def test_gymnasium_accepts_the_fleet(kind):
    pytest.importorskip("pygame")
    env = gymnasium.make("jcas/Fleet-v0", action_space=kind, uav_count=4, render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)


def test_gymnasium_makes_the_vector_environment():
    envs = gymnasium.make_vec("jcas/Fleet-v0", num_envs=3, uav_count=4)
    assert isinstance(envs.unwrapped, jcas.FleetVectorEnv)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    observations, _ = envs.reset(seed=1)
    assert observations in envs.observation_space
    synchronous = gymnasium.make_vec(
        "jcas/Fleet-v0", num_envs=2, vectorization_mode="sync", uav_count=4
    )
    assert synchronous.reset(seed=1)[0][0].tobytes() == observations[0].tobytes()


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("kind", ["box", "dict", "tuple", "discrete"])
def test_members_fly_as_single_fleets_do(kind, threads):
    fields = {"uav_count": 4, "horizon_steps": 15, "action_space": kind}
    envs = jcas.make_vec(
        num_envs=5, threads=threads, global_state=True, autoreset_mode="SameStep", **fields
    )
    singles = [jcas.FleetEnv(**fields) for _ in range(5)]
    envs.action_space.seed(3)
    observations, infos = envs.reset(seed=40)
    for member, single in enumerate(singles):
        assert np.array_equal(single.reset(seed=40 + member)[0], observations[member])
        assert np.array_equal(single.state(), infos["global_state"][member])
    for step in range(1, 16):
        actions = envs.action_space.sample()
        observations, rewards, terminated, truncated, infos = envs.step(actions)
        assert observations in envs.observation_space
        assert rewards.shape == terminated.shape == truncated.shape == (5,)
        for member, single in enumerate(singles):
            own = part_of(kind, actions, member)
            observation, reward, over, cut, info = single.step(own)
            components = info["reward_components"].tolist()
            assert infos["reward_components"][member].tolist() == components
            assert all(infos[name][member] == info[name] for name in info if name in EPISODE_INFO)
            assert rewards[member] == np.float32(reward)
            assert (terminated[member], truncated[member]) == (over, cut)
            if over or cut:
                assert np.array_equal(infos["final_obs"][member], observation)
                assert np.array_equal(infos["final_global_state"][member], single.state())
                assert infos["return_sum"][member] == info["return_sum"] != 0
            else:
                assert np.array_equal(observations[member], observation)
                assert np.array_equal(infos["global_state"][member], single.state())
        assert ("final_obs" in infos) == (step == 15)
    assert infos["_final_obs"].all() and truncated.all() and not terminated.any()
    assert not np.array_equal(infos["final_obs"], observations)


def part_of(kind, actions, member):
    if kind in ("box", "discrete"):
        return actions[member]
    if kind == "dict":
        return {name: part[member] for name, part in actions.items()}
    return tuple(part[member] for part in actions)


def test_arrays_are_the_callers_own_unless_views_are_asked_for():
    envs = jcas.make_vec(
        num_envs=2, uav_count=3, global_state=True, horizon_steps=3, autoreset_mode="SameStep"
    )
    actions = np.zeros(envs.action_space.shape, np.float32)
    seen = [arrays_of(*envs.reset(seed=1))]
    kept = [[array.copy() for array in seen[0]]]
    for _ in range(7):
        observations, rewards, terminated, truncated, infos = envs.step(actions)
        seen.append([rewards, terminated, truncated, *arrays_of(observations, infos)])
        kept.append([array.copy() for array in seen[-1]])
    for arrays, copies in zip(seen, kept, strict=True):
        assert all(np.array_equal(array, copy) for array, copy in zip(arrays, copies, strict=True))
    assert not any(
        np.shares_memory(a, b)
        for place, arrays in enumerate(seen)
        for a in arrays
        for others in seen[:place]
        for b in others
    )


def arrays_of(observations, infos):
    nested = [part for part in infos.values() if isinstance(part, dict)]
    own = [part for part in infos.values() if isinstance(part, np.ndarray)]
    return [
        observations,
        *own,
        *(array for part in nested for array in part.values() if isinstance(array, np.ndarray)),
    ]


def test_views_are_the_kernels_own_and_last_one_step_more():
    envs = jcas.make_vec(num_envs=2, uav_count=3, copy=False)
    actions = np.zeros(envs.action_space.shape, np.float32)
    first, _ = envs.reset(seed=1)
    kept = first.copy()
    second = envs.step(actions)[0]
    assert np.array_equal(first, kept)
    third = envs.step(actions)[0]
    assert np.shares_memory(first, third) and not np.shares_memory(first, second)


def test_with_one_set_of_buffers_each_step_writes_over_the_last():
    shape = {"num_envs": 2, "uav_count": 3}
    envs, twin = jcas.make_vec(**shape, copy=False, buffer_sets=1), jcas.make_vec(**shape)
    actions = np.ones(envs.action_space.shape, np.float32)
    first, _ = envs.reset(seed=1)
    twin.reset(seed=1)
    for _ in range(3):
        second, rewards, *_ = envs.step(actions)
        theirs, paid, *_ = twin.step(actions)
        assert (
            np.shares_memory(first, second)
            and np.array_equal(second, theirs)
            and np.array_equal(rewards, paid)
        )
    with pytest.raises(jcas.ArgumentError, match="buffer_sets = 3: "):
        jcas.make_vec(**shape, copy=False, buffer_sets=3)


@pytest.mark.parametrize("copy", [True, False])
def test_next_step_autoreset_is_gymnasiums(copy):
    fields = {
        "uav_count": 3,
        "hotspot_count": 1,
        "radar_cross_section_dbsm": 8.0,
        "quorum": 1,
        "horizon_steps": 12,
    }
    envs = jcas.make_vec(num_envs=4, global_state=True, copy=copy, **fields)
    rng = np.random.default_rng(1)
    envs.reset(seed=5)
    waiting, next_seeds, ended_apart = np.zeros(4, bool), {}, 0
    twins = [envs.batch.member(member) for member in range(4)]
    for _ in range(60):
        actions = rng.uniform(-1, 1, envs.action_space.shape).astype(np.float32)
        actions[waiting] = np.nan
        observations, rewards, terminated, truncated, infos = envs.step(actions)
        for member, twin in enumerate(twins):
            if waiting[member]:
                twin.reset(next_seeds[member])
                expected = (0, False, False)
                assert (infos["reward_components"][member] == 0).all()
            else:
                outcome = twin.step(actions[member])
                expected = (np.float32(outcome.reward), outcome.terminated, outcome.truncated)
            assert (rewards[member], terminated[member], truncated[member]) == expected
            assert np.array_equal(observations[member], twin.observe())
            assert np.array_equal(infos["global_state"][member], twin.observe_global())
        waiting = terminated | truncated
        ended_apart += waiting.any() and not waiting.all()
        assert ((infos["steps"] > 0) == waiting).all() and "final_obs" not in infos
        next_seeds = {
            member: derive_seed(twins[member].seed, 0) for member in np.flatnonzero(waiting)
        }
    assert ended_apart > 3


def test_next_step_and_same_step_fly_the_same_episodes():
    fields = {"uav_count": 3, "horizon_steps": 4}
    waits, goes_on = (
        jcas.make_vec(num_envs=2, autoreset_mode=mode, **fields)
        for mode in ("NextStep", "SameStep")
    )
    starts = [waits.reset(seed=9)[0]], [goes_on.reset(seed=9)[0]]
    actions = np.zeros(waits.action_space.shape, np.float32)
    for step in range(1, 16):
        observations = waits.step(actions)[0]
        if step % 5 == 0:
            starts[0].append(observations)
    for step in range(1, 13):
        observations = goes_on.step(actions)[0]
        if step % 4 == 0:
            starts[1].append(observations)
    assert len(starts[0]) == 4
    assert all(np.array_equal(a, b) for a, b in zip(*starts, strict=True))


def test_gymnasiums_vector_wrappers_count_right():
    envs = gymnasium.make_vec("jcas/Fleet-v0", num_envs=3, uav_count=3, horizon_steps=5)
    counted = gymnasium.wrappers.vector.RecordEpisodeStatistics(envs)
    normalised = gymnasium.wrappers.vector.NormalizeObservation(counted)
    normalised.reset(seed=1)
    actions = np.zeros(envs.action_space.shape, np.float32)
    for _ in range(11):
        infos = normalised.step(actions)[-1]
    assert infos["episode"]["l"].tolist() == [5, 5, 5] and counted.episode_count == 6
    np.testing.assert_allclose(infos["episode"]["r"], infos["return_sum"], rtol=1e-6)


def test_without_autoreset_an_ended_member_waits_for_its_reset():
    envs = jcas.make_vec(
        num_envs=3, uav_count=3, horizon_steps=2, autoreset_mode=AutoresetMode.DISABLED
    )
    envs.reset(seed=1)
    actions = np.zeros(envs.action_space.shape, np.float32)
    envs.step(actions)
    ended, _, _, truncated, infos = envs.step(actions)
    assert truncated.all() and "final_obs" not in infos
    assert infos["steps"].tolist() == [2, 2, 2]
    with pytest.raises(jcas.EpisodeOverError):
        envs.step(actions)
    observations, _ = envs.reset(
        seed=[4, 5, 6], options={"reset_mask": np.array([True, False, True])}
    )
    assert np.array_equal(observations[1], ended[1])
    assert np.array_equal(
        observations[2], jcas.FleetEnv(uav_count=3, horizon_steps=2).reset(seed=6)[0]
    )


def test_episodes_of_a_member_differ_and_repeat_with_the_seed():
    def starts(seed):
        envs = jcas.make_vec(num_envs=2, uav_count=3, horizon_steps=3, autoreset_mode="SameStep")
        envs.reset(seed=seed)
        steps = [envs.step(np.zeros(envs.action_space.shape, np.float32))[0] for _ in range(9)]
        return [steps[index] for index in (2, 5, 8)]

    first, again, other = starts(1), starts(1), starts(2)
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert not any(np.array_equal(a, b) for a, b in zip(first, other, strict=True))
    assert not np.array_equal(first[0], first[1]) and not np.array_equal(first[0][0], first[0][1])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"num_envs": 0}, "num_envs = 0"),
        ({"num_envs": 2, "autoreset_mode": "Never"}, "NextStep, SameStep, Disabled"),
        ({"num_envs": 2, "render_mode": "human"}, "rgb_array"),
    ],
)
def test_refusals_of_the_vector_environment(options, message):
    with pytest.raises(jcas.JcasError, match=message):
        jcas.make_vec(**options)


def test_refused_actions_of_a_batch():
    envs = jcas.make_vec(num_envs=2, uav_count=3)
    envs.reset(seed=1)
    actions = np.zeros((2, 3, 2), np.float32)
    actions[1, 2, 1] = np.nan
    with pytest.raises(jcas.ActionError, match="NaN"):
        envs.step(actions)
    with pytest.raises(jcas.ActionError, match=r"\(2, 2\).*\(2, 3, 2\)"):
        envs.step(actions[0, :2])


def test_pictures_of_every_member():
    pytest.importorskip("PIL")
    envs = jcas.make_vec(num_envs=2, uav_count=3, render_mode="rgb_array")
    envs.reset(seed=1)
    frames = envs.render()
    assert len(frames) == 2 and frames[0].shape == frames[1].shape and not np.array_equal(*frames)


@pytest.mark.heavy
def test_torchrl_wraps_fleets_that_are_reset_at_once():
    libs = pytest.importorskip("torchrl.envs")
    shape = {"num_envs": 2, "uav_count": 3, "horizon_steps": 4}
    env = libs.GymWrapper(jcas.make_vec(**shape, autoreset_mode="SameStep"))
    flown = env.rollout(6, break_when_any_done=False)
    assert env.batch_size == (2,) and flown["action"].shape == (2, 6, 3, 2)
    assert flown["next", "truncated"][:, :, 0].any(1).all()
    with pytest.raises(RuntimeError, match="SAME_STEP"):
        libs.GymWrapper(jcas.make_vec(**shape))
