"""Measures the OFDM radar of ofdm_radar.py over echoes that Sionna's ray tracer gives.

pip install numpy matplotlib sionna
python examples/radar/sionna_radar.py --out p_d.csv --figure p_d.webp

Frame, pilots, periodogram and CFAR are those of ofdm_radar.py. Gain, delay and Doppler shift of the
echo come from `RCSSolver` of Sionna RT 2.2, not from a radar equation. A target of 1 m² flies in
free space, in a random direction from the UAV that sends and receives, with a random velocity.

The cross section of `ConstantRCSSensingTarget` does not fluctuate. So each frame draws a factor of
mean power 1. `swerling1` is the complex Gaussian amplitude of ofdm_radar.py. `tr38901` is the
log-normal component of small UAVs in 3GPP TR 38.901, clause 7.9.2.1, which Sionna draws. With
`none` the target is steady. On a processor Sionna RT needs the library LLVM (Debian: libllvm19).
"""

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from ofdm_radar import Radar, channel, detections_of, false_alarms, gaussian, publish, row_of

FLUCTUATIONS = ("swerling1", "tr38901", "none")
SPEED_MAX_M_PER_S = 15.0


@dataclass(frozen=True)
class Traces:
    """What Sionna says of several echoes: amplitude in noise units, bins of delay and Doppler."""

    echo: np.ndarray
    delay: np.ndarray
    doppler: np.ndarray

    @property
    def snr(self) -> float:
        """Mean SNR of one resource element as a ratio, before any fluctuation."""
        return float(np.mean(np.abs(self.echo) ** 2))


class Scene:
    """A UAV that sends and receives, and one target in free space."""

    def __init__(self, radar: Radar) -> None:
        from sionna import rt
        from sionna.rt.rcs import ConstantRCSSensingTarget, RCSSolver

        self.radar = radar
        self.solver = RCSSolver()
        self.scene = rt.load_scene()
        self.scene.frequency = radar.carrier_hz
        antenna = rt.PlanarArray(num_rows=1, num_cols=1, pattern="iso", polarization="V")
        self.scene.tx_array = self.scene.rx_array = antenna
        self.scene.add(rt.Transmitter("sender", position=[0.0, 0.0, 0.0]))
        self.scene.add(rt.Receiver("receiver", position=[0.0, 0.0, 0.0]))
        section_m2 = 10 ** (radar.cross_section_dbsm / 10)
        self.target = ConstantRCSSensingTarget("target", sigma=section_m2)
        self.scene.add(self.target)

    def trace(self, range_m: float, count: int, rng: np.random.Generator) -> Traces:
        """Echoes from random horizontal directions at this range."""
        radar = self.radar
        azimuth = rng.uniform(0, 2 * math.pi, count)
        across = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)], axis=1)
        speed = rng.uniform(-SPEED_MAX_M_PER_S, SPEED_MAX_M_PER_S, (count, 3)) / math.sqrt(3)
        found = []
        for position, velocity in zip((range_m * across).tolist(), speed.tolist(), strict=True):
            self.target.position = position
            self.target.velocity = velocity
            paths = self.solver(self.scene, max_depth=1, samples_per_sp=1, seed=0)
            real, imaginary = (np.array(part).ravel() for part in paths.a)
            if len(real) != 1:
                raise SystemExit(f"range {range_m} m: Sionna found {len(real)} paths, must be 1")
            shift = np.array(paths.doppler).item()
            found.append((real[0], imaginary[0], np.array(paths.tau).item(), shift))
        real, imaginary, delay_s, doppler_hz = np.array(found).T
        budget_db = radar.transmit_dbm + radar.antennas_db - radar.noise_dbm
        frame_s = radar.elements / radar.bandwidth_hz
        echo = 10 ** (budget_db / 20) * (real + 1j * imaginary)
        return Traces(echo, delay_s * radar.bandwidth_hz, doppler_hz * frame_s)


def factors(fluctuation: str, rng: np.random.Generator, count: int) -> np.ndarray:
    """Factors of mean power 1 on the amplitude of each frame's echo."""
    if fluctuation == "swerling1":
        return gaussian(rng, (count,))
    if fluctuation == "none":
        return np.ones(count)
    import mitsuba as mi
    from sionna.rt.rcs import TR38901ScatteringModel

    model = TR38901ScatteringModel("uav-small-size", 1, mi.Point3f(0.0), random_sigma_s=True)
    azimuth = rng.uniform(0, 2 * math.pi, count)
    inward = mi.Vector3f(np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)]))
    power_db = model.spst.rcs_callables[0].sigma_s_db(inward, -inward, int(rng.integers(2**31)))
    return 10 ** (np.array(power_db) / 20)


def traced_echoes(
    radar: Radar, traces: Traces, fluctuation: str, rng: np.random.Generator, count: int
):
    """Echoes of traces drawn at random; the cells are those nearest to delay and Doppler."""
    chosen = rng.integers(len(traces.echo), size=count)
    echo = traces.echo[chosen] * factors(fluctuation, rng, count)
    delay, doppler = traces.delay[chosen], traces.doppler[chosen]
    gains = channel(radar, echo.astype(np.complex64), delay, doppler)
    bins = np.rint(delay).astype(int) % radar.subcarriers
    return gains, bins, np.rint(doppler).astype(int) % radar.symbols


def measure(radar: Radar, given: argparse.Namespace) -> Iterator[dict]:
    """One row for each range and pilot density; the SNR is the traced one."""
    scene = Scene(radar)
    rng = np.random.default_rng(given.seed)
    traces = {range_m: scene.trace(range_m, given.traces, rng) for range_m in given.ranges_m}
    for density in given.densities:
        alarms = false_alarms(radar, density, given.frames, given.seed)
        alarms /= given.frames * radar.elements
        for range_m, traced in traces.items():
            echoes = partial(traced_echoes, radar, traced, given.fluctuation)
            detected = detections_of(radar, echoes, density, given.frames, given.seed)
            snr = traced.snr * radar.pilots(density)
            yield row_of(radar, range_m, density, snr, given.frames, detected, alarms)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    # Whole bins of delay but for 0.1 bins, so that no target lies between two.
    spread = [30.0, 45.0, 60.0, 90.0, 120.0, 150.0]
    parser.add_argument("--frames", type=int, default=2000, help="frames for each point")
    parser.add_argument("--traces", type=int, default=100, help="traced echoes for each range")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ranges-m", type=float, nargs="+", default=spread)
    parser.add_argument("--densities", type=float, nargs="+", default=[0.30, 0.10, 0.01])
    parser.add_argument("--fluctuation", choices=FLUCTUATIONS, default=FLUCTUATIONS[0])
    parser.add_argument("--out", type=Path, default=Path("p_d.csv"), help="table to write")
    parser.add_argument("--figure", type=Path, help="picture to write")
    given = parser.parse_args()
    radar = Radar()
    publish(radar, measure(radar, given), given.out, given.figure)


if __name__ == "__main__":
    main()
