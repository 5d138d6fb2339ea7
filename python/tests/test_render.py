"""Pictures: what they show, not only that they exist."""

import dataclasses

import numpy as np
import pytest

import jcas

pytest.importorskip("PIL")
from jcas import render


def scene(**fields):
    env = jcas.FleetEnv(render_mode="rgb_array", **fields)
    env.reset(seed=4)
    env.step(np.zeros((env.model.uav_count, 2), np.float32))
    return env.sim.scene()


def count(image, color):
    return int((image == np.array(color, np.uint8)).all(axis=-1).sum())


def test_a_picture_has_its_size_and_colors():
    image = render.draw(scene())
    assert image.shape == (720, 1016, 3) and image.dtype == np.uint8
    assert count(image, render.PAPER) > 10_000 and count(image, render.WHITE) > 100_000


def test_equal_scenes_give_equal_pictures():
    assert np.array_equal(render.draw(scene()), render.draw(scene()))


@pytest.mark.parametrize(
    "change",
    [
        {"t": 50},
        {"confirmed": np.ones(5, bool)},
        {"informed": np.ones(5, bool), "confirmed": np.ones(5, bool)},
        {"grounded": np.ones(10, bool)},
        {"returning": np.ones(10, bool)},
        {"pilot_density": np.full(10, 0.01)},
        {"soc": np.full(10, 0.1)},
        {"links": np.zeros((10, 10), bool)},
        {"cells": np.arange(20).reshape(10, 2) % 12},
        {"readings": (("Return", "1.0"),)},
        {"outcome": "success"},
    ],
    ids=lambda change: next(iter(change)),
)
def test_each_quantity_shows(change):
    before = dataclasses.replace(scene(), cells=np.tile([[3, 3], [8, 8]], (5, 1)), links=np.eye(10, k=1) > 0)
    assert not np.array_equal(render.draw(before), render.draw(dataclasses.replace(before, **change)))


def test_informed_hotspots_are_green_and_undetected_ones_are_red():
    start = scene()
    done = dataclasses.replace(start, confirmed=np.ones(5, bool), informed=np.ones(5, bool))
    before, after = (render.draw(moment)[24:-24, 24:696].astype(int) for moment in (start, done))
    red, green = (
        (lambda image, high=high, low=low: int((image[..., high] > image[..., low] + 25).sum()))
        for high, low in ((0, 1), (1, 0))
    )
    assert red(before) > red(after) + 2000 and green(after) > green(before) + 2000


@pytest.mark.parametrize(
    "fields",
    [
        {"grid_width": 2, "grid_height": 3, "uav_count": 1, "quorum": 1, "hotspot_count": 1},
        {"grid_width": 200, "grid_height": 90, "uav_count": 300, "hotspot_count": 100},
    ],
)
def test_small_and_large_missions_fit(fields):
    image = render.draw(scene(**fields))
    assert image.shape[0] >= 520 and image.shape[1] < 1400
