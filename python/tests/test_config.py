"""Configurations from every source, and how refusals read."""

import pickle

import numpy as np
import pytest

import jcas


def test_the_default_is_the_mission_preset():
    config = jcas.Config()
    assert config == jcas.Config("mission") == jcas.Config(preset="mission")
    assert (config["uav_count"], config["grid_width"], config["inform_payment"]) == (10, 12, "once")


def test_keywords_dicts_and_files_agree(tmp_path):
    toml = tmp_path / "mine.toml"
    toml.write_text("preset = 'paper'\nuav_count = 15\ndepots = [[0, 0], [3, 4]]\n")
    js = tmp_path / "mine.json"
    js.write_text('{"preset": "paper", "uav_count": 15, "depots": [[0, 0], [3, 4]]}')
    fields = {"uav_count": 15, "depots": [[0, 0], [3, 4]]}
    expected = jcas.Config("paper", **fields)
    assert expected["inform_payment"] == "every_step"
    for other in (toml, str(js), {"preset": "paper", **fields}):
        assert jcas.Config(other) == expected
    assert jcas.Model(toml).config_hash == jcas.Model(expected).config_hash
    assert jcas.Config(toml, uav_count=7)["uav_count"] == 7


def test_a_detection_table_is_a_list_of_pairs():
    table = [[20.0, 0.9], [80.0, 0.1]]
    config = jcas.Config(detection_curve="table", detection_table=[(20, 0.9), (80, 0.1)])
    assert config["detection_table"] == table
    assert jcas.Config(dict(config)) == config
    # One cell is 50 m, half way: the logit is that of 9 and of 1/9, averaged.
    assert jcas.Model(config).radio(1, 0, 0.3).detection_probability == pytest.approx(0.5)
    assert jcas.Config()["detection_table"] is None
    with pytest.raises(jcas.ConfigError, match="does not rise with the range"):
        config.replace(detection_table=[(20, 0.1), (80, 0.2)])


def test_a_configuration_survives_replace_pickle_and_numpy_values():
    config = jcas.Config(uav_count=np.int64(6), detection_threshold_db=None)
    assert pickle.loads(pickle.dumps(config)) == config
    assert config.replace(uav_count=10) == jcas.Config()
    assert hash(config.replace(uav_count=10)) == hash(jcas.Config())
    assert jcas.Config(config) == config


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"uav_count": 0}, "uav_count = 0: must be a whole number from 1 to 4096"),
        ({"uav_cuont": 5}, "uav_cuont: no such field; did you mean uav_count?"),
        (
            {"pilot_density_min": 0.4},
            "pilot_density_min = 0.4: must be at most 0.3 (pilot_density_max)",
        ),
        (
            {"cell_size_m": float("nan")},
            "cell_size_m = NaN: must be a number from 0.001 to 1000000",
        ),
        ({"target_visibility": "seen"}, "target_visibility"),
        ({"preset": "best"}, "must be `mission`, `paper`"),
    ],
)
def test_refusals_name_the_field_the_value_and_what_is_allowed(fields, message):
    with pytest.raises(jcas.ConfigError) as refusal:
        jcas.Config(**fields)
    assert message in str(refusal.value)
    assert refusal.value.status != 0


def test_files_that_are_no_configuration_are_refused(tmp_path):
    file = tmp_path / "bad.json"
    file.write_text("[1, 2]")
    with pytest.raises(jcas.ConfigError):
        jcas.Config(file)
    with pytest.raises(FileNotFoundError):
        jcas.Config(tmp_path / "absent.toml")
    for options in ({"action_space": "ternary"}, {"render_mode": "ansi"}):
        with pytest.raises(jcas.ConfigError, match="must be|allowed"):
            jcas.parallel_env(**options)
