"""One object that several threads use at once: each call is made whole or raises.

The threads run in a process of their own, so that one that ends or hangs is seen as such.
"""

import copy
import pickle
import subprocess
import sys

import numpy as np
import pytest

import jcas
from jcas.in_use import Mark

SHARED = """
import sys, threading
import numpy as np
import jcas

CALLS, THREADS = 300, 4
model = jcas.Model(uav_count=6, horizon_steps=40)
many = np.zeros((8, 6, 2), np.float32)
made, refused, wrong = [0] * THREADS, [0] * THREADS, []


def vector(**settings):
    envs = jcas.make_vec(model.config, num_envs=8, **settings)
    envs.reset(seed=1)
    return lambda: envs.step(many)


def batch(threads, own_buffers):
    stepped = jcas.Batch(model, 8, threads=threads)
    shared = jcas.BatchBuffers(model, 8)
    stepped.reset(range(8), shared)
    local = threading.local()

    def step():
        if not own_buffers:
            return stepped.step(many, shared)
        if not hasattr(local, "buffers"):
            local.buffers = jcas.BatchBuffers(model, 8)
        stepped.step(many, local.buffers)

    return step


def sim():
    flown = jcas.Sim(jcas.Model(model.config, horizon_steps=CALLS * THREADS + 1, quorum=6))

    def step():
        flown.step(many[0])
        try:
            flown.observe()
            flown.reward_components()
        except jcas.BusyError:
            pass

    return step


def policy():
    flown = jcas.Sim(model)
    pilot = jcas.Policy.baseline("teams", model)
    return lambda: pilot.act(flown)


def work(step, place):
    try:
        while made[place] < CALLS:
            try:
                step()
                made[place] += 1
            except jcas.BusyError:
                refused[place] += 1
    except BaseException as error:
        wrong.append(repr(error))


sys.setswitchinterval(1e-5)
step = eval(sys.argv[1])
threads = [threading.Thread(target=work, args=(step, place)) for place in range(THREADS)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print("wrong", wrong) if wrong else print("well", sum(made), sum(refused))
"""


@pytest.mark.parametrize(
    "what",
    [
        "vector()",
        "vector(threads=2)",
        "vector(threads=2, copy=False, autoreset_mode='SameStep')",
        "vector(global_state=True)",
        "batch(1, True)",
        "batch(2, True)",
        "batch(2, False)",
        "sim()",
        "policy()",
    ],
)
def test_four_threads_on_one_object_corrupt_nothing(what):
    command = [sys.executable, "-c", SHARED, what]
    done = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("well 1200 "), done.stdout


def test_an_object_in_use_says_so_in_words():
    model = jcas.Model(uav_count=3)
    batch, buffers = jcas.Batch(model, 2), jcas.BatchBuffers(model, 2)
    batch.reset([1, 2], buffers)
    with buffers.in_use:
        with pytest.raises(jcas.BusyError, match="another thread"):
            batch.step(np.zeros((2, 3, 2), np.float32), buffers)
        with pytest.raises(jcas.BusyError, match="another thread"):
            buffers.renew()
    batch.step(np.zeros((2, 3, 2), np.float32), buffers)
    assert issubclass(jcas.BusyError, jcas.JcasError)


def test_a_copy_of_a_mark_is_free():
    mark = Mark("a thing")
    with mark:
        for twin in (copy.deepcopy(mark), pickle.loads(pickle.dumps(mark))):
            with twin, pytest.raises(jcas.BusyError), twin:
                pass
