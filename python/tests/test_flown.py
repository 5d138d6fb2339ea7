"""Tests of library policies: every baseline and the shipped network give equal bits everywhere."""

from pathlib import Path

import numpy as np
import pytest

import jcas

MISSION = Path(__file__).parents[2] / "policies" / "mission"


def fly(policy: jcas.Policy, model: jcas.Model, seed: int) -> int:
    sim = jcas.Sim(model, seed)
    while not (sim.terminated or sim.truncated):
        sim.step(policy.act(sim))
    return sim.state_hash()


@pytest.mark.parametrize(("uavs", "hotspots"), [(5, 3), (15, 7)])
def test_the_shipped_policy_flies_any_fleet_and_repeats(uavs: int, hotspots: int) -> None:
    model = jcas.Model(uav_count=uavs, hotspot_count=hotspots)
    first, second = (
        jcas.Policy.load(path, model) for path in (MISSION, MISSION / "policy.safetensors")
    )
    assert first.name == second.name == "mission"
    assert fly(first, model, 3) == fly(second, model, 3)


def test_a_mission_with_other_maps_is_refused() -> None:
    with pytest.raises(jcas.JcasError, match="reads 12 fields where this mission has 101"):
        jcas.Policy.load(MISSION, jcas.Model("search"))


def test_draws_follow_from_the_seed() -> None:
    model = jcas.Model(uav_count=5, hotspot_count=3)
    policy = jcas.Policy.load(MISSION, model, mode="sampled")
    assert fly(policy, model, 8) == fly(policy, model, 8) != fly(policy, model, 9)


def test_each_mode_flies_its_own_way() -> None:
    # A fleet that is sure of its way, as that of the preset mission is, may fly it in every mode.
    folder, model = MISSION.parent / "paper", jcas.Model("paper", uav_count=5, hotspot_count=3)

    def flown(mode: jcas.flown.Mode) -> int:
        return fly(jcas.Policy.load(folder, model, mode=mode), model, 8)

    assert flown("deterministic") != flown("sampled")
    with pytest.raises(jcas.ArgumentError, match="deterministic, sampled"):
        jcas.Policy.load(folder, model, mode="shared")


@pytest.mark.parametrize(
    "name",
    ["random", "untrained", "greedy", "teams", "squads", "line", "answer"],
)
def test_every_baseline_flies(name: str) -> None:
    model = jcas.Model(uav_count=6, hotspot_count=2, sensing_range_m=150.0)
    policy = jcas.Policy.baseline(name, model, pilot=0.2)
    assert fly(policy, model, 1) == fly(jcas.Policy.baseline(name, model, pilot=0.2), model, 1)
    assert name in repr(policy)


@pytest.mark.parametrize("name", ["random", "teams", "squads", "plan", "replan"])
def test_a_state_with_its_memory_has_the_same_future(name: str) -> None:
    model = jcas.Model("paper", uav_count=6, hotspot_count=5)
    policy = jcas.Policy.baseline(name, model)
    sim = jcas.Sim(model, 3)

    def steps(count: int) -> int:
        for _ in range(count):
            sim.step(policy.act(sim))
        return sim.state_hash()

    steps(2)
    past, memory = sim.save(), policy.save_memory(sim)
    once = steps(2)
    sim.load(past)
    if name not in ("random", "plan"):
        with pytest.raises(jcas.PolicyError, match="does not belong"):
            policy.act(sim)
    policy.load_memory(sim, memory)
    assert steps(2) == once
    with pytest.raises(jcas.PolicyError, match="does not belong"):
        policy.load_memory(sim, memory)
    with pytest.raises(jcas.SnapshotError):
        policy.load_memory(sim, memory[:-1])
    policy.forget()
    policy.act(sim)


def test_a_batch_is_acted_for_as_its_members() -> None:
    model = jcas.Model(uav_count=5, hotspot_count=3)
    policy = jcas.Policy.load(MISSION, model)
    batch = jcas.Batch(model, 3)
    buffers = jcas.BatchBuffers(model, 3)
    batch.reset([4, 5, 6], buffers)
    rows = policy.act_batch(batch)
    for row, seed in zip(rows, (4, 5, 6), strict=True):
        np.testing.assert_array_equal(row, policy.act(jcas.Sim(model, seed)))


def test_what_does_not_fit_is_refused_by_name(tmp_path: Path) -> None:
    model = jcas.Model(uav_count=5, hotspot_count=3)
    with pytest.raises(jcas.JcasError, match="fly"):
        jcas.Policy.baseline("fly", model)
    with pytest.raises(jcas.MissingFileError, match="absent"):
        jcas.Policy.load(tmp_path / "absent", model)
    broken = tmp_path / "policy.safetensors"
    broken.write_bytes(b"no weights")
    with pytest.raises(jcas.JcasError):
        jcas.Policy.load(broken, model)
    with pytest.raises(jcas.ArgumentError, match="mode"):
        jcas.Policy.load(MISSION, model, mode="boldly")  # type: ignore[arg-type]
    policy = jcas.Policy.load(MISSION, model)
    with pytest.raises(jcas.ArgumentError, match="sim"):
        policy.act(None)  # type: ignore[arg-type]
    with pytest.raises(jcas.JcasError):
        policy.act(jcas.Sim(jcas.Model(uav_count=6, hotspot_count=3)))
