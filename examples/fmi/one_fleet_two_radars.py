"""Two units in one co-simulation: one moves the fleet, the other adds a second radar.

A baseline steers the first unit. At every communication point its cells become the second unit's
positions, and its radio graph the second unit's links. So both missions are those of one fleet,
once with the paper's radar and once with one of half its range.

    cargo xtask fmu
    python examples/fmi/one_fleet_two_radars.py target/fmu/jcas.fmu [PLOT.png]

Needs FMPy (pip install fmpy), and matplotlib for the plot.
"""

import sys

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

STEP_S = 10.0
STEPS = 60


class Unit:
    """An instance of the unit, with its variables by name."""

    def __init__(self, fmu: str, name: str, uavs: int, hotspots: int) -> None:
        description = read_model_description(fmu)
        self.references = {
            variable.name: variable.valueReference for variable in description.modelVariables
        }
        self.fmu = FMU3Slave(
            guid=description.guid,
            unzipDirectory=extract(fmu),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate(loggingOn=True)
        self.fmu.enterConfigurationMode()
        self.fmu.setUInt64(
            [self.references["uav_count"], self.references["hotspot_count"]], [uavs, hotspots]
        )
        self.fmu.exitConfigurationMode()
        self.uavs, self.hotspots = uavs, hotspots

    def begin(self) -> None:
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, kind: str, name: str, values: list) -> None:
        getattr(self.fmu, f"set{kind}")([self.references[name]], values)

    def get(self, kind: str, name: str, count: int = 1) -> list:
        return list(getattr(self.fmu, f"get{kind}")([self.references[name]], nValues=count))

    def step(self, time_s: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=time_s, communicationStepSize=STEP_S)


def main(fmu: str, plot: str | None) -> None:
    uavs, hotspots = 12, 5
    fleet, payload = (Unit(fmu, name, uavs, hotspots) for name in ("fleet", "payload"))
    for unit, reach_m in ((fleet, 150.0), (payload, 75.0)):
        unit.set("UInt64", "seed", [7])
        unit.set("Float64", "sensing_range_m", [reach_m])
    fleet.set("String", "policy", ["teams"])
    payload.set("Boolean", "own_positions", [True])
    payload.set("Boolean", "own_links", [True])
    for unit in (fleet, payload):
        unit.begin()

    confirmed = []
    for step in range(STEPS):
        fleet.step(step * STEP_S)
        payload.set("UInt32", "positions", fleet.get("UInt32", "cell", 2 * uavs))
        payload.set("Boolean", "links", fleet.get("Boolean", "link", uavs * uavs))
        payload.set("Float32", "actions", [0.8, 1.0] * uavs)
        payload.step(step * STEP_S)
        confirmed.append([unit.get("UInt32", "confirmed_count")[0] for unit in (fleet, payload)])
    for name, unit, count in zip(("150 m", " 75 m"), (fleet, payload), confirmed[-1], strict=True):
        print(
            f"radar of {name}: {count} of {hotspots} confirmed, "
            f"state {unit.get('UInt64', 'state_hash')[0]:#018x}"
        )
        unit.fmu.terminate()
        unit.fmu.freeInstance()

    if plot:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        pyplot.step(
            STEP_S * np.arange(1, STEPS + 1), confirmed, where="post", label=["150 m", "75 m"]
        )
        pyplot.xlabel("time (s)")
        pyplot.ylabel("hotspots confirmed")
        pyplot.legend(title="sensing range")
        pyplot.savefig(plot)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else None)
