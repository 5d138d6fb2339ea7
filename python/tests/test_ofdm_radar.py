"""The simulated OFDM radar detects as often as the closed forms say, within binomial intervals."""

import csv
import dataclasses
import importlib.util
import math
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "examples" / "radar"
FRAMES = 1500


def loaded(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


ofdm_radar = loaded("ofdm_radar")
sionna_radar = loaded("sionna_radar")  # Imports Sionna only to trace.
RADAR = ofdm_radar.Radar(subcarriers=128, symbols=32, false_alarm_probability=1e-2)


def is_a_sample_of(count, trials, share, sigmas=4.0):
    """Whether a count of successes lies within `sigmas` standard deviations of its mean."""
    return abs(count - trials * share) <= sigmas * math.sqrt(trials * share * (1 - share))


@pytest.mark.parametrize("snr_db", [0, 6, 12, 20])
@pytest.mark.parametrize("density", [1.0, 0.3])
def test_a_swerling1_echo_is_detected_as_often_as_its_closed_form_says(snr_db, density):
    snr = 10 ** (snr_db / 10)
    detected = ofdm_radar.detections(RADAR, snr, density, FRAMES, seed=3)
    assert is_a_sample_of(detected, FRAMES, RADAR.cfar(snr))
    # The loss of the CFAR is visible with more frames only.
    assert is_a_sample_of(detected, FRAMES, RADAR.swerling1(snr), sigmas=5.0)
    # 3 dB less would be seen.
    assert not is_a_sample_of(detected, FRAMES, RADAR.cfar(snr / 2))


def test_the_closed_forms_have_the_published_values():
    radar = ofdm_radar.Radar()
    for snr_db, p_d in [(10, 0.284_804), (13.1, 0.524_631), (20, 0.872_156)]:
        assert radar.swerling1(10 ** (snr_db / 10)) == pytest.approx(p_d, abs=1e-6)
    # A long window knows the noise.
    long = dataclasses.replace(radar, training_cells=10**7)
    assert long.cfar(10.0) == pytest.approx(radar.swerling1(10.0), rel=1e-4)
    # The radar equation of docs/model.md without gain: 7.37 - 8 dB at 25 m, less 0.25 dB of δ.
    assert 10 * math.log10(radar.element_snr(25.0)) == pytest.approx(7.37 - 8 - 0.25, abs=0.01)


def test_noise_alone_raises_the_false_alarms_that_were_asked_for():
    frames = 100
    alarms = ofdm_radar.false_alarms(RADAR, 0.3, frames, seed=4)
    # Neighbouring cells share their noise estimate, so that the count varies somewhat more.
    assert is_a_sample_of(alarms, frames * RADAR.elements, 1e-2, sigmas=6.0)


def test_a_target_between_bins_is_detected_less_often():
    between = dataclasses.replace(RADAR, straddle=1.0)
    on_bin = ofdm_radar.detections(RADAR, 10.0, 1.0, FRAMES, seed=5)
    off_bin = ofdm_radar.detections(between, 10.0, 1.0, FRAMES, seed=5)
    assert off_bin < on_bin - 3 * math.sqrt(FRAMES) / 2


def test_a_traced_echo_is_looked_for_in_the_cell_nearest_to_it():
    snr = 10.0
    amplitude = math.sqrt(snr) * np.exp(1j * np.array([0.3, 2.0]))
    doppler = np.array([0.05, -0.05])

    def detected(delay):
        traces = sionna_radar.Traces(amplitude, np.array(delay), doppler)
        assert traces.snr == pytest.approx(snr)
        echoes = partial(sionna_radar.traced_echoes, RADAR, traces, "none")
        _, delay_bins, doppler_bins = echoes(np.random.default_rng(1), 50)
        assert set(delay_bins) == {20, 35} and set(doppler_bins) == {0}
        return ofdm_radar.detections_of(RADAR, echoes, 1.0, 200, seed=6)

    # At an SNR of 46 dB in the cell every frame detects, on the bin and beside it.
    assert detected([20.1, 34.9]) == 200
    assert detected([20.4, 34.6]) == 200


def test_fluctuations_have_mean_power_one():
    draws = sionna_radar.factors("swerling1", np.random.default_rng(2), 40_000)
    # The power of a Swerling-1 echo is exponential, so that its standard deviation is 1.
    assert np.mean(np.abs(draws) ** 2) == pytest.approx(1.0, abs=5 / 200)
    assert np.std(np.abs(draws) ** 2) == pytest.approx(1.0, abs=0.06)
    assert np.all(sionna_radar.factors("none", np.random.default_rng(2), 3) == 1)


def rows_of(name):
    with (FOLDER / name).open() as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    assert tuple(rows[0]) == ofdm_radar.COLUMNS
    return rows


def test_sionna_gives_the_radar_equation_and_the_closed_form():
    radar = ofdm_radar.Radar()
    for row in rows_of("p_d_sionna.csv"):
        # The model's equation has a loss of 1 + δ/R for the resolution δ; the tracer has none.
        resolution_m = ofdm_radar.LIGHT_M_PER_S / (2 * radar.bandwidth_hz)
        equation = radar.element_snr(row["range_m"]) * radar.pilots(row["pilot_density"])
        equation *= 1 + resolution_m / row["range_m"]
        assert row["snr_db"] == pytest.approx(10 * math.log10(equation), abs=2e-3)
        share = radar.cfar(equation)
        if row["pilot_density"] == 0.3:
            assert is_a_sample_of(row["detections"], row["frames"], share)


def test_the_published_table_is_that_of_the_program():
    rows = rows_of("p_d.csv")
    radar = ofdm_radar.Radar()
    for row in rows:
        snr = radar.element_snr(row["range_m"]) * radar.pilots(row["pilot_density"])
        assert row["swerling1"] == pytest.approx(radar.swerling1(snr), rel=1e-5)
        assert row["p_d"] == pytest.approx(
            (row["detections"] + 0.5) / (row["frames"] + 1), rel=1e-5
        )
        # At the highest density the pilots are many enough for the closed form.
        if row["pilot_density"] == 0.3:
            assert is_a_sample_of(row["detections"], row["frames"], radar.cfar(snr))
