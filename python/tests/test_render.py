"""Pictures: what they show, not only that they exist."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

import jcas

pytest.importorskip("PIL")
from jcas import render, sprites


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
    assert count(image, sprites.PAPER) > 10_000 and count(image, sprites.WHITE) > 100_000


def test_pictures_have_the_colors_of_the_replay_page():
    style = Path(__file__).parents[2] / "episode" / "src" / "replay" / "style.css"
    light = dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6})", style.read_text().split("@media")[0]))
    for name, color in {
        "talk": sprites.COMMUNICATING,
        "sense": sprites.SENSING,
        "link": sprites.LINK,
        "faint": sprites.DEPOT,
        "unconfirmed": sprites.UNCONFIRMED,
        "confirmed": sprites.CONFIRMED,
        "informed": sprites.INFORMED,
        "battery": sprites.BATTERY,
        "low": sprites.LOW,
    }.items():
        assert light[name] == "#" + bytes(color).hex(), name


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
        {"searched": np.ones((12, 12), bool)},
        {"sensing_range": np.full(10, 2.5)},
        {"share_knowing": np.full(5, 0.5), "confirmed": np.ones(5, bool)},
    ],
    ids=lambda change: next(iter(change)),
)
def test_each_quantity_shows(change):
    before = dataclasses.replace(
        scene(), cells=np.tile([[3, 3], [8, 8]], (5, 1)), links=np.eye(10, k=1) > 0
    )
    assert not np.array_equal(
        render.draw(before), render.draw(dataclasses.replace(before, **change))
    )


def test_informed_hotspots_are_green_and_unconfirmed_ones_are_red():
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


@pytest.mark.parametrize("fleet", [1, 2, 4, 10, 20, 25])
def test_every_uav_of_a_crowded_cell_is_seen(fleet):
    """Each shows its own pilot density, and none covers another."""
    pilots = np.linspace(0.01, 0.30, fleet)
    crowd = dataclasses.replace(
        scene(uav_count=fleet, quorum=1),
        cells=np.tile([[5, 6]], (fleet, 1)),
        pilot_density=pilots,
        hotspots=np.zeros((5, 2), int),
        depots=np.array([[11, 11]]),
        sensing_range=np.zeros(fleet),
    )
    picture, plan = render.draw(crowd), render._Plan(crowd)
    apart = [
        np.hypot(*np.subtract(a, b))
        for i, a in enumerate(plan.positions)
        for b in plan.positions[:i]
    ]
    assert min(apart, default=99) > 2.6 * max(plan.radii) and min(plan.radii) >= 3
    for (x, y), radius, pilot in zip(plan.positions, plan.radii, pilots, strict=True):
        seen = picture[round(y - 0.7 * radius), round(x)].astype(int)
        meant = sprites.ramp(sprites.PILOT_RAMP, (pilot - 0.01) / 0.29)
        assert np.abs(seen - meant).max() < 60, (seen, meant)


def test_more_than_a_cell_has_room_for_are_counted():
    crowd = dataclasses.replace(scene(uav_count=40), cells=np.tile([[5, 6]], (40, 1)))
    assert len(set(render._Plan(crowd).positions)) == 1
    thinner = dataclasses.replace(crowd, cells=np.concatenate([crowd.cells[:39], [[0, 0]]]))
    assert not np.array_equal(
        render.draw(crowd)[300:400, 300:400], render.draw(thinner)[300:400, 300:400]
    )


def test_searched_cells_and_sensing_range_are_where_they_belong():
    searched = np.zeros((12, 12), bool)
    searched[0, 11] = True  # x = 11, y = 0: bottom right.
    cells = np.tile([[2, 2]], (10, 1))
    empty = dataclasses.replace(
        scene(),
        cells=cells,
        searched=searched,
        hotspots=np.full((5, 2), 9),
        links=np.zeros((10, 10), bool),
        trail=(),
    )
    picture = render.draw(dataclasses.replace(empty, sensing_range=np.r_[np.zeros(9), 1.9]))
    side, middle = 56, lambda cell: 24 + round((cell + 0.5) * 56)
    assert tuple(picture[middle(11), middle(11)]) == sprites.SEARCHED
    assert tuple(picture[middle(11), middle(10)]) == sprites.WHITE
    # 1.9 cells: the next cell but one still lies half inside, the third does not.
    tinted = picture[middle(9), middle(3)]
    assert tinted[0] > tinted[2] + 10
    assert tuple(picture[middle(9), middle(4)]) == sprites.WHITE and side == render.cell_side_px(
        12, 12
    )


def test_the_legend_names_everything_that_is_drawn(monkeypatch):
    written = []
    kept = sprites.write
    monkeypatch.setattr(
        sprites,
        "write",
        lambda image, place, text, *rest: (written.append(text), kept(image, place, text, *rest)),
    )
    render._background.cache_clear()
    render.draw(scene())
    told = " ".join(written)
    for word in (
        "communicates", "senses", "unconfirmed", "confirmed", "informed", "share that knows",
        "battery", "returning",
        "grounded", "depot", "link", "moves", "detects", "visited cells",
    ):  # fmt: skip
        assert word in told, word


def test_the_sensing_range_is_where_a_tenth_is_detected():
    model = jcas.Model("paper", detection_threshold_db=-23.8)
    far = model.sensing_range(0.30)
    inside, outside = (
        model.radio(cells, 0, 0.30).detection_probability for cells in (int(far), int(far) + 1)
    )
    assert inside >= 0.1 > outside and model.sensing_range(0.01) < far
    assert (
        jcas.Model().sensing_range(0.30) < 2
        and jcas.Model(radar_cross_section_dbsm=-90).sensing_range(0.3) == 0
    )
    assert jcas.Model(detection_threshold_db=-300).sensing_range(0.3) == 12
