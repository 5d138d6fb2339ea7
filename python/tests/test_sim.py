"""The simulation itself: its quantities, snapshots and forks."""

import pickle

import numpy as np
import pytest

import jcas


def flown(steps=20, **fields):
    sim = jcas.Sim(jcas.Model(**fields), seed=3)
    rng = np.random.default_rng(0)
    for _ in range(steps):
        sim.step(rng.uniform(-1, 1, (sim.model.uav_count, 2)).astype(np.float32))
    return sim


def test_quantities_agree_with_each_other_and_with_the_configuration():
    sim = flown(uav_count=7, hotspot_count=4)
    model = sim.model
    assert (model.uav_count, model.hotspot_count) == (7, 4)
    assert model.observation_len == 11 + 4 * 4 + 3 * 6
    assert model.global_len == 6 * 7 + 4 * 4 + 4
    assert sim.t == 20 and not sim.terminated and not sim.truncated
    cells = sim.cells()
    assert cells.shape == (7, 2) and (cells < 12).all()
    observations = sim.observe()
    np.testing.assert_allclose(observations[:, :2] * 11, cells, atol=1e-5)
    np.testing.assert_allclose(observations[:, 2], sim.soc(), atol=1e-6)
    pilots = sim.pilot_densities()
    assert ((pilots >= 0.01) & (pilots <= 0.30)).all()
    np.testing.assert_allclose(observations[:, 3], (pilots - 0.01) / 0.29, atol=1e-6)
    links = sim.links()
    assert links.shape == (7, 7) and np.array_equal(links, links.T) and not links.diagonal().any()
    np.testing.assert_allclose(observations[:, 11 + 16 + 18 - 6], links.sum(axis=1) / 6, atol=1e-6)
    assert sim.knowledge().shape == (7, 4)
    assert sim.hotspot_cells().shape == (4, 2) and len(np.unique(sim.hotspot_cells(), axis=0)) == 4
    metrics = sim.metrics()
    capacity = 0.20
    stored = sim.soc() * capacity
    assert metrics["energy_kwh"] == pytest.approx(
        7 * capacity - stored.sum() + metrics["accepted_kwh"], abs=1e-12
    )


def test_links_follow_the_link_budget():
    model = jcas.Model()
    assert model.radio(2, 0, 0.30).link_throughput >= 1.0 > model.radio(3, 0, 0.30).link_throughput
    assert model.radio(1, 0, 0.01).comm_snr_db == pytest.approx(32.30, abs=0.01)
    assert model.radio(0, 0, 0.30).detection_probability == pytest.approx(0.16, abs=0.03)
    assert (
        model.radio(0, 0, 0.30).detection_probability
        > model.radio(0, 0, 0.01).detection_probability
    )
    with pytest.raises(jcas.JcasError):
        model.radio(12, 0, 0.30)


def test_a_snapshot_brings_everything_back():
    sim = flown()
    saved, hashed, observed = sim.save(), sim.state_hash(), sim.observe()
    actions = np.full((10, 2), 0.5, np.float32)
    outcomes = [sim.step(actions) for _ in range(10)]
    assert sim.state_hash() != hashed
    other = jcas.Sim(jcas.Model())
    other.load(saved)
    assert other.state_hash() == hashed and np.array_equal(other.observe(), observed)
    assert [other.step(actions) for _ in range(10)] == outcomes
    assert other.save() == sim.save()


def test_a_fork_goes_its_own_way():
    sim = flown()
    twin = sim.fork()
    assert twin.state_hash() == sim.state_hash()
    twin.step(np.ones((10, 2), np.float32))
    assert twin.t == sim.t + 1 and twin.state_hash() != sim.state_hash()
    copied = pickle.loads(pickle.dumps(sim))
    assert copied.state_hash() == sim.state_hash() and copied.model.config == sim.model.config


def test_environments_save_load_and_fork():
    for env in (jcas.parallel_env(uav_count=4), jcas.FleetEnv(uav_count=4)):
        env.reset(seed=2)
        saved = env.save()
        fork = env.fork()
        action = np.zeros((4, 2), np.float32)
        step = (
            dict(zip(env.possible_agents, action, strict=True))
            if hasattr(env, "possible_agents")
            else action
        )
        env.step(step)
        fork.step(step)
        assert env.save() == fork.save() != saved
        env.load(saved)
        assert env.save() == saved


def test_damaged_snapshots_are_refused_and_change_nothing():
    sim = flown()
    saved = sim.save()
    sim.step(np.zeros((10, 2), np.float32))
    before = sim.state_hash()
    flipped = bytearray(saved)
    flipped[len(saved) // 2] ^= 1
    other = flown(uav_count=9).save()
    for bad in (b"", saved[:-1], saved + b"\0", bytes(flipped), other):
        with pytest.raises(jcas.SnapshotError):
            sim.load(bad)
        assert sim.state_hash() == before


def test_observations_can_be_written_into_a_buffer_of_the_caller():
    sim = flown()
    out = np.zeros((10, sim.model.observation_len), np.float32)
    assert sim.observe(out) is out and np.array_equal(out, sim.observe())
    for bad in (np.zeros((10, 3), np.float32), out.astype(np.float64), out[:, ::-1]):
        with pytest.raises((ValueError, TypeError)):
            sim.observe(bad)


def test_a_model_outlives_its_name():
    sim = jcas.Sim(jcas.Model(uav_count=3))
    assert sim.step(np.zeros((3, 2), np.float32)).reward == pytest.approx(
        sim.metrics()["return_sum"]
    )


UNSEEN = {"detection_threshold_db": 300.0}
"""Hotspots that nobody finds, so that no mission ends early."""


@pytest.mark.parametrize(
    "fields", [{}, {"preset": "search", **UNSEEN}, {"uav_tag": "index", "uav_count": 4}]
)
def test_observation_fields_name_every_entry_once(fields):
    sim = flown(**fields)
    places = sim.model.observation_fields()
    assert sorted(np.concatenate(list(places.values())).tolist()) == list(
        range(sim.model.observation_len)
    )
    observations = sim.observe()
    np.testing.assert_allclose(observations[:, places["soc"]][:, 0], sim.soc(), atol=1e-6)
    assert places["hotspot_dx"].size == sim.model.hotspot_count


def test_false_alarms_confirm_cells_without_a_hotspot():
    config = jcas.Config(false_alarm_per_cell=0.2, quorum=2, sensing_footprint_m=100)
    sim = jcas.Sim(jcas.Model(config))
    sim.reset(1)
    actions = np.zeros((sim.model.uav_count, 2), np.float32)
    confirmed = sim.false_confirmations()
    for _ in range(5):
        sim.step(actions)
        alarms, after = sim.false_alarms(), sim.false_confirmations()
        assert np.array_equal(after, confirmed | (alarms.sum(axis=0) >= 2))
        assert not alarms[:, sim.hotspot_cells()[:, 1], sim.hotspot_cells()[:, 0]].any()
        confirmed = after
    assert sim.metrics()["false_confirmations"] == confirmed.sum() > 0
    silent = jcas.Sim(jcas.Model())
    assert silent.false_alarms().shape == (0, 12, 12) and silent.false_confirmations().size == 0


def test_reports_count_what_one_uav_saw():
    config = jcas.Config(
        uav_count=1,
        quorum=2,
        false_alarm_per_cell=0.3,
        sensing_footprint_m=100,
        report_levels=2,
        report_slots=3,
    )
    sim = jcas.Sim(jcas.Model(config))
    sim.reset(1)
    seen = np.zeros(sim.false_confirmations().shape, int)
    for _ in range(6):
        sim.step(np.zeros((1, 2), np.float32))
        seen += sim.false_alarms()[0]
    x, y = sim.hotspot_cells().T
    at_hotspots = np.zeros(seen.shape, bool)
    at_hotspots[y, x] = True
    reports = sim.reports()[0]
    assert np.array_equal(reports[~at_hotspots], np.minimum(seen, 2)[~at_hotspots])
    assert reports.max() == 2
    field = sim.model.observation_fields()["report_level"]
    assert np.isin(sim.observe()[0, field], [0.5, 1]).all()
    assert jcas.Sim(jcas.Model()).reports().shape == (0, 12, 12)


def test_search_maps_grow_and_show_in_pictures():
    env = jcas.FleetEnv("search", render_mode="rgb_array", **UNSEEN)
    env.reset(seed=1)
    config = env.model.config
    before = env.sim.search_maps()
    assert before.shape == (env.model.uav_count, config["grid_height"], config["grid_width"])
    env.action_space.seed(1)
    for _ in range(10):
        env.step(env.action_space.sample())
    after = env.sim.search_maps()
    assert after.sum() > before.sum() and (after | before == after).all()
    scene = env.sim.scene()
    assert (
        np.array_equal(scene.searched, after.any(axis=0)) and scene.searched_by == "searched cells"
    )
    assert jcas.Sim(jcas.Model()).search_maps().shape == (0, 12, 12)
