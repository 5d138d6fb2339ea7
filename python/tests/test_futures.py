"""Tests of forks and rollouts: each environment makes what a simulation alone makes."""

import numpy as np
import pytest

import jcas

MEMBERS, STEPS = 4, 20


def begun(name: str) -> tuple[jcas.Model, jcas.Policy, jcas.Sim]:
    model = jcas.Model(uav_count=5, hotspot_count=2, horizon_steps=15)
    policy, sim = jcas.Policy.baseline(name, model), jcas.Sim(model, 3)
    for _ in range(3):
        sim.step(policy.act(sim))
    return model, policy, sim


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("seeds", [None, range(MEMBERS)])
@pytest.mark.parametrize("name", ["greedy", "teams", "line"])
def test_rollouts_are_what_policy_and_step_make_in_turn(name, seeds, threads):
    model, policy, sim = begun(name)
    batch = jcas.Batch(model, MEMBERS, threads=threads)
    policy.fork_batch(batch, sim, seeds)
    made = policy.rollout_batch(batch, STEPS)
    ends = [batch.member(index).state_hash() for index in range(MEMBERS)]
    assert made.steps.tolist() == [12] * MEMBERS and made.truncated.all()

    policy.fork_batch(batch, sim, seeds)
    buffers = jcas.BatchBuffers(model, MEMBERS)
    actions = np.zeros((MEMBERS, 12, 5, 2), np.float32)
    for step in range(12):
        actions[:, step] = policy.act_batch(batch)
        batch.step(actions[:, step], buffers, auto_reset=False)
    assert ends == [batch.member(index).state_hash() for index in range(MEMBERS)]
    assert (buffers.final_metrics == made.metrics).all()

    batch.fork(sim, seeds)
    given = batch.rollout(actions)
    assert given.returns.tolist() == made.returns.tolist()
    assert ends == [batch.member(index).state_hash() for index in range(MEMBERS)]
    assert len(set(ends)) == (1 if seeds is None else MEMBERS)


def test_bad_arguments_are_refused_by_name():
    model, policy, sim = begun("teams")
    batch = jcas.Batch(model, MEMBERS)
    with pytest.raises(jcas.ResetNeededError, match="rollout before the first reset"):
        policy.rollout_batch(batch, 3)
    with pytest.raises(jcas.ArgumentError, match="seeds has 1 entries"):
        batch.fork(sim, [1])
    with pytest.raises(jcas.ArgumentError, match="sim = 3"):
        policy.fork_batch(batch, 3)
    with pytest.raises(jcas.ArgumentError, match="another configuration"):
        policy.fork_batch(jcas.Batch(jcas.Model(), 2), sim)
    policy.fork_batch(batch, sim)
    before = batch.save()
    with pytest.raises(jcas.ArgumentError, match="steps = 0"):
        policy.rollout_batch(batch, 0)
    for shape in [(MEMBERS, 5, 2), (MEMBERS, 0, 5, 2), (MEMBERS, 3, 4, 2)]:
        with pytest.raises(jcas.ActionError, match="the shape is"):
            batch.rollout(np.zeros(shape))
    actions = np.zeros((MEMBERS, 3, 5, 2))
    actions[2, 1, 4, 0] = np.nan
    with pytest.raises(jcas.ActionError, match=r"environment 2: actions\[4\]\[0\] = NaN"):
        batch.rollout(actions)
    sim.step(policy.act(sim))
    sim.step(np.zeros((5, 2)))
    sim.step(np.zeros((5, 2)))
    with pytest.raises(jcas.PolicyError, match="remembers"):
        policy.fork_batch(batch, sim)
    assert batch.save() == before
