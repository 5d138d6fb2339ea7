"""Simulates an OFDM radar that integrates its pilots, and measures how often it detects.

pip install numpy matplotlib
python examples/radar/ofdm_radar.py --out p_d.csv --figure p_d.png

A frame is a grid of subcarriers and symbols. Each element carries a random QPSK symbol, and a share
of them, the pilots, is known to the radar. The echo of a Swerling-1 target has a complex Gaussian
amplitude, constant during a frame. The radar divides the received pilots by the sent ones and
leaves the other elements at 0. It transforms the quotients over subcarriers and symbols, and
compares each cell of the periodogram with its neighbours in range (CA-CFAR). All points of one
pilot density see the same noise, so that their differences are not its effect.
"""

import argparse
import csv
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

COLUMNS = ("range_m", "pilot_density", "snr_db", "frames", "detections", "p_d")
COLUMNS += ("swerling1_cfar", "swerling1", "false_alarms_per_cell")
LIGHT_M_PER_S = 299_792_458.0
BATCH_FRAMES = 100
QPSK = np.exp(0.25j * np.pi * np.arange(1, 8, 2)).astype(np.complex64)
# Takes a generator and a number of frames. Gives the channel of each element (frames, subcarriers,
# symbols) in units of the noise's amplitude, and each target's bins of delay and of Doppler.
Echoes = Callable[[np.random.Generator, int], tuple[np.ndarray, np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Radar:
    """The waveform, the detector, and the budget of docs/model.md."""

    subcarriers: int = 256
    symbols: int = 64
    false_alarm_probability: float = 1e-6
    # Cells on each side of the cell under test: first those left out, then those averaged.
    guard_cells: int = 2
    training_cells: int = 32
    carrier_hz: float = 5.8e9
    bandwidth_hz: float = 100e6
    transmit_dbm: float = 20.0
    antennas_db: float = 4.0
    cross_section_dbsm: float = 0.0
    noise_dbm: float = -90.0
    # Targets lie this far around a bin of delay and of Doppler, in bins; 0: on it.
    straddle: float = 0.0

    @property
    def elements(self) -> int:
        return self.subcarriers * self.symbols

    @property
    def training(self) -> int:
        """Number of cells whose mean is the noise estimate."""
        return 2 * self.training_cells

    def pilots(self, density: float) -> int:
        """Number of pilots of a frame, at least one."""
        return max(1, round(density * self.elements))

    def element_snr(self, range_m: float) -> float:
        """SNR of one resource element as a ratio: the radar equation with 1 + δ/R."""
        wavelength_m = LIGHT_M_PER_S / self.carrier_hz
        resolution_m = LIGHT_M_PER_S / (2 * self.bandwidth_hz)
        budget_db = self.transmit_dbm + self.antennas_db + self.cross_section_dbsm - self.noise_dbm
        spread = wavelength_m**2 / ((4 * math.pi) ** 3 * range_m**4)
        return 10 ** (budget_db / 10) * spread / (1 + resolution_m / range_m)

    def swerling1(self, snr: float) -> float:
        """P_d with a known noise power: the curve `swerling1` of docs/model.md."""
        return self.false_alarm_probability ** (1 / (1 + snr))

    def threshold(self) -> float:
        """Threshold over the noise estimate (H. Finn, R. Johnson, RCA Review 29, 1968)."""
        return self.training * (self.false_alarm_probability ** (-1 / self.training) - 1)

    def cfar(self, snr: float) -> float:
        """P_d of a Swerling-1 target behind the CA-CFAR, whose noise estimate is a mean."""
        return (1 + self.threshold() / (self.training * (1 + snr))) ** -self.training


def gaussian(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    """Complex Gaussian numbers of mean power 1."""
    parts = rng.standard_normal((*shape, 2), dtype=np.float32)
    return parts.view(np.complex64)[..., 0] * np.float32(math.sqrt(0.5))


def noise_estimate(power: np.ndarray, radar: Radar) -> np.ndarray:
    """Mean of the training cells around each cell, along the range (axis 1), which wraps around."""
    reach = radar.guard_cells + radar.training_cells
    padded = np.concatenate([power[:, -reach:], power, power[:, :reach]], axis=1)
    sums = np.cumsum(padded, axis=1, dtype=np.float64)
    sums = np.concatenate([np.zeros_like(sums[:, :1]), sums], axis=1)

    def window(half: int) -> np.ndarray:
        begin = reach - half
        count = power.shape[1]
        return sums[:, begin + 2 * half + 1 :][:, :count] - sums[:, begin:][:, :count]

    return (window(reach) - window(radar.guard_cells)) / radar.training


def swerling1_echoes(radar: Radar, snr: float, rng: np.random.Generator, count: int):
    """Echoes of a Swerling-1 target at random bins. The SNR is that of an element, a ratio."""
    delay = rng.integers(radar.subcarriers, size=count)
    doppler = rng.integers(radar.symbols, size=count)
    offset = radar.straddle * (rng.random((2, count)) - 0.5)
    echo = math.sqrt(snr) * gaussian(rng, (count,))
    return channel(radar, echo, delay + offset[0], doppler + offset[1]), delay, doppler


def channel(radar: Radar, echo, delay, doppler) -> np.ndarray:
    """Channel of each element, from the amplitude of an echo and its bins, which may be broken."""
    over_subcarriers = turns(-delay, radar.subcarriers)
    over_symbols = turns(doppler, radar.symbols)
    return (echo[:, None] * over_subcarriers)[:, :, None] * over_symbols[:, None, :]


def periodograms(
    radar: Radar, rng: np.random.Generator, echoes: Echoes, density: float, count: int
):
    """Periodograms of frames over range and Doppler, in units of the noise.

    Returns an array (frames, subcarriers, symbols), and the bins of delay and of Doppler at which
    each frame has its target.
    """
    pilots = radar.pilots(density)
    known = np.zeros(radar.elements, dtype=bool)
    known[rng.permutation(radar.elements)[:pilots]] = True
    known = known.reshape(radar.subcarriers, radar.symbols)
    sent = QPSK[rng.integers(4, size=(count, *known.shape), dtype=np.uint8)]
    gains, delay, doppler = echoes(rng, count)
    received = gains * sent + gaussian(rng, gains.shape)
    quotient = np.where(known, received / sent, np.complex64(0))
    cells = np.fft.ifft(np.fft.fft(quotient, axis=2), axis=1) * radar.subcarriers
    return np.abs(cells) ** 2 / pilots, delay, doppler


def turns(bins: np.ndarray, length: int) -> np.ndarray:
    """A row of phases for each number of full turns over a length."""
    return np.exp(2j * np.pi / length * np.outer(bins, np.arange(length))).astype(np.complex64)


def batches(frames: int) -> Iterator[int]:
    """Numbers of frames that fit in memory together, and whose sum is `frames`."""
    for begin in range(0, frames, BATCH_FRAMES):
        yield min(BATCH_FRAMES, frames - begin)


def detections(radar: Radar, snr: float, density: float, frames: int, seed: int) -> int:
    """Number of frames in which the radar detects a Swerling-1 target whose cell has this SNR."""
    echoes = partial(swerling1_echoes, radar, snr / radar.pilots(density))
    return detections_of(radar, echoes, density, frames, seed)


def detections_of(radar: Radar, echoes: Echoes, density: float, frames: int, seed: int) -> int:
    """Number of frames in which the radar detects the target of these echoes."""
    rng = np.random.default_rng([seed, radar.pilots(density)])
    detected = 0
    for count in batches(frames):
        power, delay, doppler = periodograms(radar, rng, echoes, density, count)
        # The range profile at the target's Doppler bin, which is all that its cell is compared to.
        profile = power[np.arange(count), :, doppler]
        over = profile > radar.threshold() * noise_estimate(profile, radar)
        detected += int(over[np.arange(count), delay].sum())
    return detected


def false_alarms(radar: Radar, density: float, frames: int, seed: int) -> int:
    """Number of cells of frames without an echo in which the radar detects one."""
    rng = np.random.default_rng([seed, radar.pilots(density), 1])
    silence = partial(swerling1_echoes, radar, 0.0)
    alarms = 0
    for count in batches(frames):
        power, _, _ = periodograms(radar, rng, silence, density, count)
        alarms += int((power > radar.threshold() * noise_estimate(power, radar)).sum())
    return alarms


def measure(radar: Radar, ranges_m, densities, frames: int, seed: int) -> Iterator[dict]:
    """One row for each range and pilot density."""
    for density in densities:
        alarms = false_alarms(radar, density, frames, seed) / (frames * radar.elements)
        for range_m in ranges_m:
            snr = radar.element_snr(range_m) * radar.pilots(density)
            detected = detections(radar, snr, density, frames, seed)
            yield row_of(radar, range_m, density, snr, frames, detected, alarms)


def row_of(radar: Radar, range_m, density, snr, frames: int, detected: int, alarms) -> dict:
    """A row of the table.

    P_d is (detections + 1/2)/(frames + 1), which is neither 0 nor 1, so that it has a logit.
    """
    numbers = (range_m, density, 10 * math.log10(snr), frames, detected)
    numbers += ((detected + 0.5) / (frames + 1), radar.cfar(snr), radar.swerling1(snr))
    return dict(zip(COLUMNS, (*numbers, alarms), strict=True))


def publish(radar: Radar, rows: Iterator[dict], out: Path, figure: Path | None) -> None:
    """Prints the rows as they come, and writes the table and the picture."""
    kept = []
    for row in rows:
        kept.append(row)
        print("  ".join(f"{name} {value:g}" for name, value in row.items()), flush=True)
    with out.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows({name: f"{number:.6g}" for name, number in row.items()} for row in kept)
    if figure:
        draw(radar, kept, figure)


def interval(share: float, frames: int, z: float = 1.96) -> tuple[float, float]:
    """Wilson's interval of a share of frames."""
    centre = (share + z * z / (2 * frames)) / (1 + z * z / frames)
    inner = share * (1 - share) / frames + z * z / (4 * frames * frames)
    half = z * math.sqrt(inner) / (1 + z * z / frames)
    return centre - half, centre + half


def draw(radar: Radar, rows: list[dict], path: Path) -> None:
    """Measured P_d with 95 % intervals beside both closed forms, over the range."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7.2, 4.4), layout="constrained")
    densities = sorted({row["pilot_density"] for row in rows}, reverse=True)
    colours = pyplot.get_cmap("viridis")(np.linspace(0.0, 0.8, len(densities)))
    dashed = {"linestyle": "--", "linewidth": 1}
    dots = {"linestyle": "none", "marker": "o", "markersize": 4}
    longest_m = max(row["range_m"] for row in rows)
    ranges_m = np.linspace(longest_m / 200, longest_m, 200)
    for density, colour in zip(densities, colours, strict=True):
        snrs = [radar.element_snr(range_m) * radar.pilots(density) for range_m in ranges_m]
        known = [radar.swerling1(snr) for snr in snrs]
        axes.plot(ranges_m, known, color=colour, label=f"pilot density {density:g}")
        axes.plot(ranges_m, [radar.cfar(snr) for snr in snrs], color=colour, **dashed)
        chosen = [row for row in rows if row["pilot_density"] == density]
        measured = np.array([row["p_d"] for row in chosen])
        bounds = np.array([interval(row["p_d"], int(row["frames"])) for row in chosen])
        errors = np.abs(bounds.T - measured)
        axes.errorbar([row["range_m"] for row in chosen], measured, errors, color=colour, **dots)
    axes.plot([], [], color="grey", label="swerling1, coherent")
    axes.plot([], [], color="grey", label="the same behind CA-CFAR", **dashed)
    axes.plot([], [], color="grey", label="measured", **dots)
    axes.set(xlabel="range in m", ylabel="probability of detection $P_d$", ylim=(-0.02, 1.02))
    axes.grid(alpha=0.3)
    axes.legend(fontsize=9)
    figure.savefig(path, dpi=110)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    spread = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 110.0, 120.0]
    spread += [140.0, 160.0, 180.0, 200.0]
    parser.add_argument("--frames", type=int, default=10_000, help="frames for each point")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ranges-m", type=float, nargs="+", default=spread)
    parser.add_argument("--densities", type=float, nargs="+", default=[0.30, 0.10, 0.03, 0.01])
    parser.add_argument("--subcarriers", type=int, default=256)
    parser.add_argument("--symbols", type=int, default=64)
    parser.add_argument("--false-alarm-probability", type=float, default=1e-6)
    parser.add_argument("--noise-dbm", type=float, default=-90.0)
    parser.add_argument("--straddle", action="store_true", help="targets lie between bins too")
    parser.add_argument("--out", type=Path, default=Path("p_d.csv"), help="table to write")
    parser.add_argument("--figure", type=Path, help="picture to write")
    return parser.parse_args()


def main() -> None:
    given = arguments()
    radar = Radar(
        given.subcarriers,
        given.symbols,
        given.false_alarm_probability,
        noise_dbm=given.noise_dbm,
        straddle=float(given.straddle),
    )
    rows = measure(radar, given.ranges_m, given.densities, given.frames, given.seed)
    publish(radar, rows, given.out, given.figure)


if __name__ == "__main__":
    main()
