"""Tests of the unit in FMPy: validity, the bits of the Python interface, saved states, refusals.

Run them by `JCAS_FMU=target/fmu/jcas.fmu pytest fmi/tests`.
"""

import os

import jcas
import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

FMU = os.environ["JCAS_FMU"]
STEP_S = 10.0


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    return extract(FMU, unzipdir=str(tmp_path_factory.mktemp("fmu")))


class Unit:
    def __init__(self, folder, uavs=10, hotspots=5, **parameters):
        description = read_model_description(FMU)
        self.variables = {variable.name: variable for variable in description.modelVariables}
        self.messages = []
        self.fmu = FMU3Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier="jcas",
            instanceName="unit",
        )
        self.fmu.instantiate(loggingOn=True)
        self.fmu.enterConfigurationMode()
        self.set("uav_count", uavs)
        self.set("hotspot_count", hotspots)
        self.fmu.exitConfigurationMode()
        for name, value in parameters.items():
            self.set(name, value)
        self.time_s = 0.0

    def begin(self):
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def set(self, name, *values):
        variable = self.variables[name]
        getattr(self.fmu, f"set{variable.type}")([variable.valueReference], list(values))

    def get(self, name, count=1):
        variable = self.variables[name]
        values = getattr(self.fmu, f"get{variable.type}")([variable.valueReference], nValues=count)
        return values[0] if count == 1 else list(values)

    def step(self, steps=1):
        self.fmu.doStep(currentCommunicationPoint=self.time_s, communicationStepSize=steps * STEP_S)
        self.time_s += steps * STEP_S

    def hash(self):
        return self.get("state_hash")


def test_the_description_is_valid():
    assert validate_fmu(FMU) == []


def test_it_simulates_with_nothing_said():
    outputs = ["confirmed_count", "energy_kwh", "terminated"]
    result = simulate_fmu(
        FMU, start_values={"policy": "teams"}, output=outputs, output_interval=STEP_S
    )
    assert result["confirmed_count"][-1] > 0
    assert np.all(np.diff(result["energy_kwh"]) >= 0)


def test_every_field_of_the_configuration_is_a_parameter(unpacked):
    unit = Unit(unpacked)
    for name in jcas.Config():
        assert name in unit.variables, name


def test_actions_fly_the_same_bits_as_through_python(unpacked):
    sim = jcas.Sim(jcas.Model(jcas.Config(uav_count=6, hotspot_count=3, quorum=2)), seed=11)
    unit = Unit(unpacked, 6, 3, quorum=2, seed=11).begin()
    random = np.random.default_rng(5)
    for _ in range(25):
        actions = random.uniform(-1, 1, (6, 2)).astype(np.float32)
        sim.step(actions)
        unit.set("actions", *actions.ravel().tolist())
        unit.step()
        assert unit.hash() == sim.state_hash()
    assert unit.get("cell", 12) == sim.cells().ravel().tolist()
    batteries_kwh = (sim.batteries_uj() / 3.6e12).tolist()
    assert unit.get("battery_kwh", 6) == pytest.approx(batteries_kwh, abs=0)


def test_two_units_in_one_process_do_not_know_of_each_other(unpacked):
    alone = Unit(unpacked, policy="greedy", seed=3).begin()
    alone.step(20)
    one = Unit(unpacked, policy="greedy", seed=3).begin()
    other = Unit(unpacked, 4, 2, policy="random", seed=8).begin()
    for _ in range(20):
        one.step()
        other.step()
    assert one.hash() == alone.hash()
    assert one.hash() != other.hash()


@pytest.mark.parametrize("policy", ["", "teams", "random"])
def test_a_state_that_is_kept_goes_on_alike(unpacked, policy):
    unit = Unit(unpacked, policy=policy, seed=2).begin()
    unit.step(7)
    kept = unit.fmu.getFMUState()
    written = unit.fmu.serializeFMUState(kept)
    unit.step(9)
    ahead = unit.hash()
    unit.fmu.setFMUState(kept)
    unit.fmu.freeFMUState(kept)
    unit.time_s = 7 * STEP_S
    unit.step(9)
    assert unit.hash() == ahead

    second = Unit(unpacked).begin()
    read = second.fmu.deserializeFMUState(written)
    second.fmu.setFMUState(read)
    second.time_s = 7 * STEP_S
    second.step(9)
    assert second.hash() == ahead


def test_the_importer_may_own_positions_and_links(unpacked):
    unit = Unit(unpacked, 3, 1, own_positions=True, own_links=True).begin()
    unit.set("positions", 0, 0, 5, 5, 11, 11)
    unit.set("links", *[i != k for i in range(3) for k in range(3)])
    unit.step()
    assert unit.get("cell", 6) == [0, 0, 5, 5, 11, 11]
    assert sum(unit.get("link", 9)) == 6


def test_the_state_holds_after_the_end(unpacked):
    unit = Unit(unpacked, horizon_steps=5).begin()
    unit.step(5)
    assert unit.get("truncated")
    ended = unit.hash()
    unit.step(3)
    assert unit.hash() == ended


@pytest.mark.parametrize(
    "wrong",
    [
        lambda unit: unit.step(0.5),
        lambda unit: unit.fmu.doStep(currentCommunicationPoint=99.0, communicationStepSize=STEP_S),
        lambda unit: unit.set("quorum", 2),
        lambda unit: unit.set("actions", 0.0),
        lambda unit: unit.set("actions", *[float("nan")] * 20) or unit.step(),
        lambda unit: unit.set("time", 1.0),
        lambda unit: unit.fmu.getFloat64([999_999]),
        lambda unit: unit.fmu.getFloat64([unit.variables["cell"].valueReference]),
        lambda unit: unit.fmu.deserializeFMUState(b"not a state"),
        lambda unit: unit.fmu.enterInitializationMode(),
    ],
)
def test_what_is_wrong_is_an_error_and_changes_nothing(unpacked, wrong):
    unit = Unit(unpacked, seed=4).begin()
    unit.step()
    before = unit.hash()
    with pytest.raises(FMICallException):
        wrong(unit)
    assert unit.hash() == before


def test_a_parameter_that_is_no_number_is_refused(unpacked):
    unit = Unit(unpacked)
    with pytest.raises(FMICallException):
        unit.set("cell_size_m", float("nan"))


@pytest.mark.parametrize(
    "name, value", [("quorum", 0), ("policy", "fly"), ("preset", "moon"), ("cell_size_m", -1.0)]
)
def test_a_parameter_that_is_not_legal_is_refused_at_the_start(unpacked, name, value):
    unit = Unit(unpacked, **{name: value} if name != "policy" else {"policy": value})
    unit.fmu.enterInitializationMode()
    with pytest.raises(FMICallException):
        unit.fmu.exitInitializationMode()
