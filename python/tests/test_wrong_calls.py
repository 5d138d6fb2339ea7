"""A hundred wrong calls: each raises an error that names what is wrong, and none ends the process.

They are made in a process of their own, so that one that does end it is seen as such.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np

import jcas
from jcas.evaluation import evaluate

F32 = np.float32
HUGE = 2**64


def things():
    """What the calls are made on, the same for each of them."""
    model = jcas.Model(uav_count=4, hotspot_count=3)
    sim = jcas.Sim(model, seed=1)
    batch, buffers = jcas.Batch(model, 3), jcas.BatchBuffers(model, 3)
    batch.reset([1, 2, 3], buffers)
    parallel, fleet, turns = (
        make(uav_count=4) for make in (jcas.parallel_env, jcas.FleetEnv, jcas.env)
    )
    hybrid = jcas.parallel_env(uav_count=4, action_space="dict")
    discrete = jcas.parallel_env(uav_count=4, action_space="discrete")
    envs, closed = jcas.make_vec(num_envs=3, uav_count=4), jcas.FleetEnv(uav_count=4)
    for env in (parallel, fleet, turns, hybrid, discrete, envs, closed):
        env.reset(seed=1)
    closed.close()
    return {
        "model": model, "sim": sim, "batch": batch, "buffers": buffers, "parallel": parallel,
        "fleet": fleet,
        "turns": turns, "hybrid": hybrid, "envs": envs, "discrete": discrete, "closed": closed,
        "ok": np.zeros((3, 4, 2), F32),
        "each": {agent: np.zeros(2, F32) for agent in parallel.possible_agents}, "jcas": jcas,
        "np": np,
        "F32": F32, "HUGE": HUGE, "other": jcas.Model(uav_count=5), "evaluate": evaluate,
    }  # fmt: skip


# The call, and what its message must name.
CALLS = [
    # Configurations.
    ("jcas.Config(16)", "config"),
    ("jcas.Config(3.5)", "config"),
    ("jcas.Config(['mission'])", "config"),
    ("jcas.Config(b'mission')", "config"),
    ("jcas.Config('best')", "best"),
    ("jcas.Config('')", "preset"),
    ("jcas.Config('absent.toml')", "absent.toml"),
    ("jcas.Config({1: 2})", "1"),
    ("jcas.Config(uav_count='ten')", "uav_count"),
    ("jcas.Config(uav_count=2.5)", "uav_count"),
    ("jcas.Config(uav_count=True)", "uav_count"),
    ("jcas.Config(uav_count=-1)", "uav_count"),
    ("jcas.Config(uav_count=2**70)", "uav_count"),
    ("jcas.Config(uav_count=np.arange(3))", "uav_count"),
    ("jcas.Config(cell_size_m='wide')", "cell_size_m"),
    ("jcas.Config(cell_size_m=[1])", "cell_size_m"),
    ("jcas.Config(cell_size_m=float('nan'))", "cell_size_m"),
    ("jcas.Config(cell_size_m=1j)", "cell_size_m"),
    ("jcas.Config(cell_size_m=object())", "cell_size_m"),
    ("jcas.Config(inform_payment='twice')", "inform_payment"),
    ("jcas.Config(inform_payment=1)", "inform_payment"),
    ("jcas.Config(depots=5)", "depots"),
    ("jcas.Config(depots=[[1]])", "depots"),
    ("jcas.Config(depots=[['a', 'b']])", "depots"),
    ("jcas.Config(depots=[[99, 99]])", "depots"),
    ("jcas.Config(detection_curve='table', detection_table=0.5)", "detection_table"),
    ("jcas.Config(detection_curve='table', detection_table=[[50]])", "detection_table"),
    ("jcas.Config(detection_curve='table', detection_table=[[50, 'high']])", "detection_table"),
    ("jcas.Config(detection_table=[[50, 0.5]])", "detection_table"),
    ("jcas.Config(uav_cuont=5)", "uav_cuont"),
    ("jcas.Config(**{'a b\\n': 5})", "a b"),
    ("jcas.Config(preset=3)", "preset"),
    ("jcas.Model(uav_count=0)", "uav_count"),
    # Models and simulations.
    ("model.radio(2**32, 0, 0.1)", "dx"),
    ("model.radio(0, 12, 0.1)", "dy"),
    ("model.radio(0.5, 0, 0.1)", "dx"),
    ("model.radio(0, 0, float('nan'))", "pilot_density"),
    ("model.radio(0, 0, 'high')", "pilot_density"),
    ("model.radio(0, 0, 0.9)", "pilot_density"),
    ("model.sensing_range(0.1, float('nan'))", "probability"),
    ("model.sensing_range(0.1, 2)", "probability = 2"),
    ("model.sensing_range(0.1, -1)", "probability = -1"),
    ("model.sensing_range(0.1, 0)", "probability = 0"),
    ("jcas.Policy.load('a\\0b', model)", "cannot be read"),
    ("jcas.Recorder(None, 1)", "sim"),
    ("jcas.run_episode(np.zeros)", "model"),
    ("jcas.Sim(None)", "model"),
    ("jcas.Sim(sim)", "model"),
    ("jcas.Sim(model, seed=-1)", "seed"),
    ("sim.reset(HUGE)", "seed"),
    ("sim.reset('one')", "seed"),
    ("sim.reset(1.0)", "seed"),
    ("sim.reset(None)", "seed"),
    ("sim.step(np.zeros((3, 2)))", "actions"),
    ("sim.step(np.zeros((4, 2), complex))", "actions"),
    ("sim.step([['up', 1]] * 4)", "actions"),
    ("sim.step([[0, 1], [0]])", "actions"),
    ("sim.step(None)", "actions"),
    ("sim.step(np.full((4, 2), np.nan))", "NaN"),
    ("sim.observe(np.zeros((4, 3), F32))", "out"),
    ("sim.observe(np.zeros(sim.observe().shape))", "out"),
    ("sim.observe(np.asfortranarray(sim.observe()))", "out"),
    ("sim.observe(np.broadcast_to(F32(0), sim.observe().shape))", "out"),
    ("sim.observe([[0.0]])", "out"),
    ("sim.observe_global(np.zeros(3, F32))", "out"),
    ("sim.load('text')", "snapshot"),
    ("sim.load(7)", "snapshot"),
    ("sim.load(None)", "snapshot"),
    ("sim.load(b'')", "snapshot"),
    ("sim.load(jcas.Sim(other).save())", "configuration"),
    # Batches.
    ("jcas.Batch(None, 3)", "model"),
    ("jcas.Batch(model, 0)", "num_envs"),
    ("jcas.Batch(model, 2**32 + 1)", "num_envs"),
    ("jcas.Batch(model, 2.0)", "num_envs"),
    ("jcas.Batch(model, 3, threads=-1)", "threads"),
    ("jcas.Batch(model, 3, threads=0)", "threads"),
    ("jcas.Batch(model, 3, threads=10**6)", "threads"),
    ("jcas.BatchBuffers(model, -1)", "num_envs"),
    ("jcas.BatchBuffers(None, 1)", "model"),
    ("batch.reset([1, 2], buffers)", "seeds"),
    ("batch.reset(5, buffers)", "seeds"),
    ("batch.reset([1, 2, -3], buffers)", "seeds[2]"),
    ("batch.reset([1, 2, HUGE], buffers)", "seeds[2]"),
    ("batch.reset([1, 2, 0.5], buffers)", "seeds[2]"),
    ("batch.reset([1, 2, 3], None)", "buffers"),
    ("batch.step(ok, jcas.BatchBuffers(model, 2))", "buffers"),
    ("batch.step(ok, jcas.BatchBuffers(other, 3))", "buffers"),
    ("batch.step(ok, object())", "buffers"),
    ("batch.step(ok[:, :, :1], buffers)", "actions"),
    ("batch.step(ok.ravel(), buffers)", "actions"),
    ("batch.step('go', buffers)", "actions"),
    ("batch.step(None, buffers)", "actions"),
    ("batch.step(ok * np.nan, buffers)", "NaN"),
    ("jcas.Batch(model, 3).step(ok, buffers)", "reset"),
    ("batch.observe(None)", "buffers"),
    ("batch.member(3)", "index"),
    ("batch.member(-1)", "index"),
    ("batch.member(2**32)", "index"),
    ("batch.set_member(0, None)", "sim"),
    ("batch.set_member(0, jcas.Sim(other))", "sim"),
    ("batch.load(b'short')", "snapshot"),
    ("setattr(buffers, 'observations', np.zeros(1))", "observations"),
    # Environments.
    ("jcas.parallel_env(action_space='ternary')", "action_space"),
    ("jcas.parallel_env(action_space='discrete', pilot_levels=0)", "pilot_levels"),
    ("jcas.FleetEnv(uav_count=4, frameskip=1)", "unexpected keyword argument 'frameskip'"),
    ("jcas.make_vec(num_envs=2, seeding='random')", "seeding"),
    ("discrete.step({agent: 15 for agent in discrete.agents})", "action of uav_0"),
    ("discrete.step({agent: 0.5 for agent in discrete.agents})", "action of uav_0"),
    ("discrete.step({agent: [1, 2] for agent in discrete.agents})", "action of uav_0"),
    ("envs.step(np.where(np.arange(24).reshape(3, 4, 2) == 13, np.nan, 0))", "mission 1, UAV 2"),
    ("closed.step(ok[0])", "close"),
    ("fleet.render()", "render_mode"),
    ("jcas.parallel_env(render_mode='ansi')", "render_mode"),
    ("jcas.parallel_env(max_cycles=5, horizon_steps=6)", "max_cycles"),
    ("jcas.parallel_env(uav_count=4).step(each)", "reset"),
    ("jcas.FleetEnv().step(np.zeros((10, 2)))", "reset"),
    ("jcas.env().step(np.zeros(2))", "reset"),
    ("jcas.make_vec(num_envs=3, uav_count=4).step(ok)", "reset"),
    ("parallel.reset(seed=-1)", "seed"),
    ("parallel.reset(seed=HUGE)", "seed"),
    ("parallel.reset(options={'snapshot': b'x'})", "snapshot"),
    ("parallel.step({})", "uav_0"),
    ("parallel.step([0] * 4)", "actions"),
    ("parallel.step({**each, 'uav_9': np.zeros(2)})", "uav_9"),
    ("parallel.step({**each, 'uav_2': np.zeros(3)})", "uav_2"),
    ("parallel.step({**each, 'uav_2': 'up'})", "uav_2"),
    ("parallel.action_space('uav_4')", "agent"),
    ("hybrid.step({agent: {'motion': 7, 'pilot': [0]} for agent in hybrid.agents})",
     "motion of uav_0"),
    ("hybrid.step({agent: {'motion': 1.5, 'pilot': [0]} for agent in hybrid.agents})",
     "motion of uav_0"),
    ("hybrid.step({agent: {'motion': 1, 'pilot': [0, 0]} for agent in hybrid.agents})",
     "pilot of uav_0"),
    ("hybrid.step({agent: {'motion': 1} for agent in hybrid.agents})", "pilot"),
    ("fleet.reset(seed='one')", "seed"),
    ("fleet.step(np.zeros((4, 3)))", "actions"),
    ("fleet.load(b'none')", "snapshot"),
    ("turns.load(7)", "snapshot"),
    ("jcas.make_vec(16)", "config"),
    ("jcas.make_vec(num_envs=2.5)", "num_envs"),
    ("jcas.make_vec(num_envs=2, threads=-1)", "threads"),
    ("jcas.make_vec(num_envs=2, autoreset_mode='Never')", "autoreset_mode"),
    ("jcas.make_vec(num_envs=2, render_mode='human')", "render_mode"),
    ("envs.reset(seed=[1, 2])", "seed"),
    ("envs.reset(seed=[1, 2, -3])", "seed[2]"),
    ("envs.reset(seed=1.5)", "seed"),
    ("envs.reset(options={'reset_mask': [True]})", "reset_mask"),
    ("envs.reset(options={'reset_mask': [1, 0, 1]})", "reset_mask"),
    ("envs.step(ok[:2])", "actions"),
    ("envs.step(np.zeros((3, 4, 2), object))", "actions"),
    ("envs.load(b'x')", "snapshot"),
    # Policies, traces, campaigns.
    ("jcas.trained_on('absent')", "absent"),
    ("evaluate(None, model)", "act"),
    ("evaluate(lambda rows: rows, model, episodes=2)", "actions"),
    ("evaluate(lambda rows: rows, model, episodes=0)", "episodes"),
    ("jcas.replay_trace('absent.jsonl')", "absent.jsonl"),
]  # fmt: skip

# Digits of an object's address may look like one of the words below.
ADDRESS = re.compile(r"0x[0-9a-f]+")
FOREIGN_WORDS = (
    "u32",
    "f64",
    "usize",
    "i128",
    "--",
    "jcas config",
    "variant",
    "sequence",
    "TOML parse",
)
"""What a message must not hold: words of other languages and commands."""


def make_all_calls():
    """Make every call and print what came of each, a line for each as it comes."""
    names = things()
    for call, _ in CALLS:
        try:
            exec(call, dict(names))
            print(json.dumps([call, None, None]), flush=True)
        except Exception as error:
            print(json.dumps([call, type(error).__name__, str(error)]), flush=True)
    names["batch"].step(names["ok"], names["buffers"])
    names["sim"].step(names["ok"][0])
    names["parallel"].step(names["each"])


def test_wrong_calls_raise_errors_that_name_the_argument():
    assert len(CALLS) >= 100 and len(dict(CALLS)) == len(CALLS)
    done = subprocess.run([sys.executable, Path(__file__)], capture_output=True, text=True)
    results = [json.loads(line) for line in done.stdout.splitlines()]
    after = f"after {results[-1] if results else 'nothing'}: {done.stderr[-2000:]}"
    assert done.returncode == 0 and len(results) == len(CALLS), after
    for (call, named), (made, kind, message) in zip(CALLS, results, strict=True):
        assert made == call and kind is not None, f"{call} was accepted"
        assert named in message and message, f"{call}: {kind}: {message}"
        words = ADDRESS.sub("", message)
        assert not any(word in words for word in FOREIGN_WORDS), f"{call}: {kind}: {message}"


if __name__ == "__main__":
    make_all_calls()
