"""Tests of batches in a forked process: a batch with threads raises an error and never hangs."""

import os
import signal
import time

import numpy as np
import pytest

import jcas

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")

PATIENCE_S = 60


def in_child(act) -> int:
    """Run a function in a forked process; give its exit status, or fail where it hangs."""
    child = os.fork()
    if child == 0:
        try:
            os._exit(act())
        finally:
            os._exit(99)
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.01)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    pytest.fail("the forked process hangs")


def flying(threads: int) -> tuple[jcas.Batch, jcas.BatchBuffers, np.ndarray]:
    model = jcas.Model(uav_count=5, hotspot_count=3)
    batch, buffers = jcas.Batch(model, 8, threads=threads), jcas.BatchBuffers(model, 8)
    batch.reset(range(8), buffers)
    actions = np.zeros((8, 5, 2), np.float32)
    batch.step(actions, buffers)
    return batch, buffers, actions


def test_a_batch_with_threads_refuses_to_step_after_a_fork_and_can_be_dropped():
    batch, buffers, actions = flying(threads=3)

    def act() -> int:
        nonlocal batch
        try:
            batch.step(actions, buffers)
        except jcas.JcasError as error:
            assert "parent process" in str(error)
        else:
            return 1
        before = batch.member(0).state_hash()
        del batch
        # One that is built here steps.
        own, own_buffers, _ = flying(threads=3)
        own.step(actions, own_buffers)
        return 0 if before else 2

    assert in_child(act) == 0
    batch.step(actions, buffers)


def test_a_batch_without_threads_goes_on_after_a_fork():
    batch, buffers, actions = flying(threads=1)

    def act() -> int:
        batch.step(actions, buffers)
        return 0

    assert in_child(act) == 0


def test_a_vector_environment_with_threads_raises_after_a_fork():
    envs = jcas.make_vec(num_envs=6, threads=2, uav_count=4, hotspot_count=2)
    envs.reset(seed=1)

    def act() -> int:
        try:
            envs.step(np.zeros(envs.action_space.shape, np.float32))
        except jcas.JcasError:
            return 0
        return 1

    assert in_child(act) == 0
