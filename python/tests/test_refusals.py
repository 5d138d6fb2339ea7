"""Mistakes of new users: each raises the documented error, says what helps, and changes nothing."""

import contextlib
import copy
import io
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import jcas

ROOT = Path(__file__).parents[2]
MISSION = ROOT / "policies" / "mission"
WEIGHTS = MISSION / "policy.safetensors"


@pytest.fixture(scope="module")
def model():
    return jcas.Model(uav_count=5, hotspot_count=3)


# Policies.


def test_a_file_that_is_no_policy_is_a_policy_error(model, tmp_path):
    broken = tmp_path / "policy.safetensors"
    broken.write_bytes(b"no weights")
    with pytest.raises(jcas.PolicyError, match="safetensors"):
        jcas.Policy.load(tmp_path, model)
    weights = bytearray(WEIGHTS.read_bytes())
    weights[-2:] = b"\x01\x7e"  # The last weight, half precision: not a number.
    broken.write_bytes(weights)
    with pytest.raises(jcas.PolicyError, match="finite"):
        jcas.Policy.load(broken, model)


def test_a_policy_of_other_observations_is_a_policy_error():
    with pytest.raises(jcas.PolicyError, match="policy.safetensors"):
        jcas.Policy.load(MISSION, jcas.Model(target_visibility="hidden"))


@pytest.mark.parametrize("name", ["fly", "", "teams\0x", "tëams"])
def test_a_baseline_that_is_none_is_an_argument_error(model, name):
    with pytest.raises(jcas.ArgumentError):
        jcas.Policy.baseline(name, model)
    with pytest.raises(jcas.ArgumentError):
        jcas.Policy.baseline("teams", model, pilot="mid\0")


def test_acting_for_another_model_says_so(model):
    policy, other = jcas.Policy.baseline("teams", model), jcas.Model(uav_count=6)
    with pytest.raises(jcas.ArgumentError, match="another configuration"):
        policy.act(jcas.Sim(other))
    with pytest.raises(jcas.ArgumentError, match="another configuration"):
        policy.act_batch(jcas.Batch(other, 2))
    assert policy.act(jcas.Sim(jcas.Model(model.config))).shape == (5, 2)


def pickled(policy):
    return pickle.loads(pickle.dumps(policy))


@pytest.mark.parametrize("how", [copy.copy, copy.deepcopy, pickled])
def test_policies_can_be_copied(model, how):
    sim = jcas.Sim(model, seed=3)
    for policy in (
        jcas.Policy.load(MISSION, model, mode="sampled"),
        jcas.Policy.baseline("greedy", model, pilot=0.2),
    ):
        twin = how(policy)
        assert (twin.name, repr(twin)) == (policy.name, repr(policy))
        np.testing.assert_array_equal(twin.act(sim), policy.act(sim))


# Files.


def test_a_file_that_is_not_there_is_one_error(model, tmp_path):
    absent = tmp_path / "absent"
    for read in (
        lambda: jcas.Config(f"{absent}.toml"),
        lambda: jcas.Config(f"{absent}.json"),
        lambda: jcas.Policy.load(absent, model),
        lambda: jcas.trained_on(absent),
        lambda: jcas.Trace.load(absent),
        lambda: jcas.replay_trace(absent),
    ):
        with pytest.raises(jcas.MissingFileError, match="absent"):
            read()
    assert issubclass(jcas.MissingFileError, FileNotFoundError)
    assert issubclass(jcas.MissingFileError, jcas.JcasError)


# Environments.


UNKNOWN = [{"resetmask": [True, False]}, {"snapshots": b""}, [1], "snapshot", 3, {"seed": 4}]


def vector(**fields):
    return jcas.make_vec(num_envs=2, **fields)


@pytest.mark.parametrize("options", UNKNOWN)
def test_unknown_options_of_a_reset_are_refused(options):
    for make in (jcas.parallel_env, jcas.FleetEnv, jcas.env, vector):
        env = make(uav_count=3)
        env.reset(seed=1)
        before = env.save()
        with pytest.raises(jcas.ArgumentError, match="options"):
            env.reset(options=options)
        assert env.save() == before


@pytest.mark.parametrize("seed", [np.array(3), np.array([3]), 3.0, "3", -1, True])
def test_a_seed_that_is_none_is_refused_before_anything_changes(seed):
    for make in (jcas.parallel_env, jcas.FleetEnv, jcas.env):
        env = make(uav_count=3)
        env.reset(seed=1)
        before = env.save()
        with pytest.raises(jcas.ArgumentError, match="seed"):
            env.reset(seed=seed)
        assert env.save() == before
        env.reset(seed=np.int64(3))


def test_actions_in_an_array_where_a_dict_belongs_are_refused():
    env = jcas.parallel_env(uav_count=3)
    env.reset(seed=1)
    with pytest.raises(jcas.ActionError, match="must be a dict with an action for each agent"):
        env.step(np.zeros((3, 2), np.float32))


def test_a_vector_environment_says_how_it_resets():
    envs = jcas.make_vec(num_envs=2, uav_count=3, autoreset_mode="SameStep")
    assert envs.autoreset_mode == envs.metadata["autoreset_mode"]
    assert copy.deepcopy(envs).autoreset_mode == envs.autoreset_mode


# Configurations and help.


def test_a_derived_field_reads_as_none():
    config = jcas.Config()
    names = [field["name"] for field in jcas.Config.fields()]
    assert all(config[name] is None or name in config for name in names)
    assert config["depots"] is None and "depots" not in config and "depots" not in dict(config)
    assert jcas.Config(depots=[(1, 2)])["depots"] == [[1, 2]]
    assert jcas.Config(depots=config["depots"]) == config
    with pytest.raises(KeyError):
        config["depot"]


def test_help_is_short():
    with contextlib.redirect_stdout(io.StringIO()) as text:
        help(jcas.parallel_env)
    assert len(text.getvalue()) < 4000 and "ForwardRef" not in text.getvalue()


def test_the_readmes_lines_are_typed(tmp_path):
    pytest.importorskip("mypy")
    text = (ROOT / "python" / "README.md").read_text(encoding="utf-8")
    script = tmp_path / "readme.py"
    code = "".join(part.split("```")[0] for part in text.split("```python\n")[1:])
    script.write_text(code, encoding="utf-8")
    settings = str(ROOT / "python" / "pyproject.toml")
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--config-file", settings, str(script)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert checked.returncode == 0, checked.stdout
