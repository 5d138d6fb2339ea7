"""Draws a mission: a map of the fleet and a panel of its state, as an RGB array."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import MissingDependencyError

if TYPE_CHECKING:
    from .scene import Scene

SUPERSAMPLING = 2
MAP_SIDE_PX = 672
MARGIN_PX = 24
PANEL_PX = 296
PANEL_ROWS_MAX = 20

INK = (31, 41, 55)
MUTED = (120, 130, 145)
PAPER = (246, 247, 250)
WHITE = (255, 255, 255)
LINE = (228, 232, 239)
LINK = (20, 148, 146)
DEPOT = (71, 85, 105)
UNSEEN = (222, 62, 92)
CONFIRMED = (240, 160, 32)
INFORMED = (34, 158, 94)
LOW = (214, 64, 69)
COMMUNICATING = (57, 106, 214)
SENSING = (244, 114, 32)
GROUNDED = (148, 155, 166)
PILOT_RAMP = (COMMUNICATING, (160, 108, 196), SENSING)

Color = tuple[int, ...]
Point = tuple[float, float]


def draw(scene: Scene) -> npt.NDArray[np.uint8]:
    """Draw a scene as an array of shape [height, width, 3]."""
    image, canvas = _canvas(scene)
    plan = _MapPlan(scene)
    _draw_ground(canvas, plan)
    _draw_trail(canvas, plan)
    _draw_hotspots(canvas, plan)
    _draw_links(canvas, plan)
    _draw_fleet(canvas, plan)
    _draw_panel(canvas, plan)
    small = image.resize((image.width // SUPERSAMPLING, image.height // SUPERSAMPLING), 1)
    return np.asarray(small, dtype=np.uint8).copy()


class _MapPlan:
    """Where the cells of a scene lie in the picture, in supersampled pixels."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.cell = cell_side_px(scene) * SUPERSAMPLING
        self.left = self.top = float(MARGIN_PX * SUPERSAMPLING)
        self.width = self.cell * scene.grid_width
        self.height = self.cell * scene.grid_height
        self.radius = max(self.cell * 0.19, 3.0 * SUPERSAMPLING)
        self.positions = self._spread_fleet()

    def centre(self, x: float, y: float) -> Point:
        """The middle of a cell; y grows upwards on the map."""
        return (
            self.left + (x + 0.5) * self.cell,
            self.top + (self.scene.grid_height - 0.5 - y) * self.cell,
        )

    def _spread_fleet(self) -> list[Point]:
        """UAVs of one cell stand in a ring around its middle, so that each of them is seen."""
        members: dict[tuple[int, int], list[int]] = {}
        for uav, (x, y) in enumerate(self.scene.cells.tolist()):
            members.setdefault((x, y), []).append(uav)
        places: list[Point] = [(0.0, 0.0)] * len(self.scene.cells)
        for (x, y), uavs in members.items():
            centre_x, centre_y = self.centre(x, y)
            ring = 0.0 if len(uavs) == 1 else self.cell * (0.21 if len(uavs) < 5 else 0.28)
            for place, uav in enumerate(uavs):
                angle = 2 * math.pi * place / len(uavs) - math.pi / 2
                places[uav] = (centre_x + ring * math.cos(angle), centre_y + ring * math.sin(angle))
        return places

    def uav_radius(self, uav: int) -> float:
        """UAVs that share a cell are drawn smaller."""
        crowd = int((self.scene.cells == self.scene.cells[uav]).all(axis=1).sum())
        return self.radius if crowd == 1 else max(self.radius * (0.8 if crowd < 5 else 0.55), 2.5 * SUPERSAMPLING)


def cell_side_px(scene: Scene) -> int:
    """Side of a cell in the finished picture."""
    return max(4, MAP_SIDE_PX // max(scene.grid_width, scene.grid_height))


def _canvas(scene: Scene) -> tuple[Any, Any]:
    try:
        from PIL import Image, ImageDraw
    except ImportError as error:
        raise MissingDependencyError("Pillow", "rendering", "render") from error
    side = cell_side_px(scene)
    width = side * scene.grid_width + 2 * MARGIN_PX + PANEL_PX
    height = max(side * scene.grid_height + 2 * MARGIN_PX, 520)
    image = Image.new("RGB", (width * SUPERSAMPLING, height * SUPERSAMPLING), PAPER)
    return image, ImageDraw.Draw(image, "RGBA")


def _font(size: float) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(size * SUPERSAMPLING)


def _circle(canvas: Any, centre: Point, radius: float, **style: Any) -> None:
    canvas.ellipse((centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius), **style)


def _blend(low: Color, high: Color, share: float) -> Color:
    share = min(max(share, 0.0), 1.0)
    return tuple(round(a + (b - a) * share) for a, b in zip(low, high, strict=True))


def _ramp(stops: tuple[Color, ...], share: float) -> Color:
    place = min(max(share, 0.0), 1.0) * (len(stops) - 1)
    low = min(int(place), len(stops) - 2)
    return _blend(stops[low], stops[low + 1], place - low)


def _draw_ground(canvas: Any, plan: _MapPlan) -> None:
    scene = plan.scene
    right, bottom = plan.left + plan.width, plan.top + plan.height
    canvas.rounded_rectangle(
        (plan.left - 6, plan.top - 6, right + 6, bottom + 6), radius=14, fill=WHITE, outline=LINE, width=2
    )
    if plan.cell >= 12 * SUPERSAMPLING:
        for column in range(1, scene.grid_width):
            x = plan.left + column * plan.cell
            canvas.line((x, plan.top, x, bottom), fill=LINE, width=2)
        for row in range(1, scene.grid_height):
            y = plan.top + row * plan.cell
            canvas.line((plan.left, y, right, y), fill=LINE, width=2)
    for x, y in scene.depots.tolist():
        centre_x, centre_y = plan.centre(x, y)
        half = plan.cell * 0.44
        box = (centre_x - half, centre_y - half, centre_x + half, centre_y + half)
        canvas.rounded_rectangle(box, radius=plan.cell * 0.12, fill=(*DEPOT, 28), outline=(*DEPOT, 150), width=3)


def _draw_trail(canvas: Any, plan: _MapPlan) -> None:
    steps = [*plan.scene.trail, plan.scene.cells]
    for age in range(1, len(steps)):
        alpha = round(70 * age / len(steps))
        for before, after in zip(steps[age - 1].tolist(), steps[age].tolist(), strict=True):
            if before != after:
                ends = (*plan.centre(*before), *plan.centre(*after))
                canvas.line(ends, fill=(*COMMUNICATING, alpha), width=max(3, round(plan.cell * 0.05)))


def _draw_hotspots(canvas: Any, plan: _MapPlan) -> None:
    scene = plan.scene
    half = max(plan.cell * 0.3, 4.0 * SUPERSAMPLING)
    for hotspot, (x, y) in enumerate(scene.hotspots.tolist()):
        centre_x, centre_y = plan.centre(x, y)
        diamond = [
            (centre_x, centre_y - half),
            (centre_x + half, centre_y),
            (centre_x, centre_y + half),
            (centre_x - half, centre_y),
        ]
        color = _hotspot_color(scene, hotspot)
        canvas.polygon(diamond, fill=(*color, 60 if color == UNSEEN else 150))
        canvas.line(
            [*diamond, diamond[0], diamond[1]],
            fill=color,
            width=max(3, round(plan.cell * 0.04)),
            joint="curve",
        )
        if scene.confirmed[hotspot] and not scene.informed[hotspot]:
            ring = half * 1.25
            box = (centre_x - ring, centre_y - ring, centre_x + ring, centre_y + ring)
            end = -90 + 360 * float(scene.share_knowing[hotspot])
            canvas.arc(box, -90, end, fill=INFORMED, width=max(3, round(plan.cell * 0.05)))


def _hotspot_color(scene: Scene, hotspot: int) -> Color:
    if scene.informed[hotspot]:
        return INFORMED
    return CONFIRMED if scene.confirmed[hotspot] else UNSEEN


def _draw_links(canvas: Any, plan: _MapPlan) -> None:
    uavs = len(plan.positions)
    alpha = 110 if uavs <= 12 else max(30, 900 // uavs)
    for i, j in np.argwhere(np.triu(plan.scene.links, 1)).tolist():
        canvas.line((*plan.positions[i], *plan.positions[j]), fill=(*LINK, alpha), width=3)


def _draw_fleet(canvas: Any, plan: _MapPlan) -> None:
    scene = plan.scene
    for uav, centre in enumerate(plan.positions):
        radius = plan.uav_radius(uav)
        ring = radius * 1.38
        thickness = max(3, round(radius * 0.26))
        box = (centre[0] - ring, centre[1] - ring, centre[0] + ring, centre[1] + ring)
        soc = float(scene.soc[uav])
        _circle(canvas, centre, ring, fill=WHITE)
        canvas.arc(box, 0, 360, fill=LINE, width=thickness)
        if soc > 0:
            canvas.arc(box, -90, -90 + 360 * min(soc, 1.0), fill=_battery_color(soc), width=thickness)
        _circle(canvas, centre, radius, fill=_uav_color(scene, uav))
        if scene.returning[uav]:
            _circle(canvas, centre, radius * 0.42, fill=WHITE)
        elif uav < 100 and radius > 9 * SUPERSAMPLING:
            canvas.text(centre, str(uav), fill=WHITE, font=_font(radius / SUPERSAMPLING * 1.05), anchor="mm")


def _battery_color(soc: float) -> Color:
    return _ramp((LOW, CONFIRMED, INFORMED), (soc - 0.1) / 0.5)


def _uav_color(scene: Scene, uav: int) -> Color:
    if scene.grounded[uav]:
        return GROUNDED
    span = max(scene.pilot_density_max - scene.pilot_density_min, 1e-9)
    share = (float(scene.pilot_density[uav]) - scene.pilot_density_min) / span
    return _ramp(PILOT_RAMP, share)


def _draw_panel(canvas: Any, plan: _MapPlan) -> None:
    scene = plan.scene
    s = SUPERSAMPLING
    left = plan.left + plan.width + MARGIN_PX * s
    right = left + (PANEL_PX - MARGIN_PX) * s
    y = plan.top
    canvas.text((left, y), f"Step {scene.t} of {scene.horizon_steps}", fill=INK, font=_font(21))
    if scene.outcome:
        color = INFORMED if scene.outcome == "success" else UNSEEN
        canvas.text((right, y + 5 * s), scene.outcome, fill=color, font=_font(15), anchor="ra")
    y += 33 * s
    _bar(canvas, (left, y, right, y + 6 * s), scene.t / max(scene.horizon_steps, 1), COMMUNICATING)
    y += 22 * s
    total = len(scene.hotspots)
    for label, flags, color in (
        ("Confirmed", scene.confirmed, CONFIRMED),
        ("Informed", scene.informed, INFORMED),
    ):
        done = int(flags.sum())
        y = _reading(canvas, left, right, y, label, f"{done} / {total}")
        _bar(canvas, (left, y, right, y + 6 * s), done / max(total, 1), color)
        y += 16 * s
    for label, value in scene.readings:
        y = _reading(canvas, left, right, y, label, value)
    y += 8 * s
    legend_top = plan.top + max(plan.height, (520 - 2 * MARGIN_PX) * s) - 84 * s
    _draw_batteries(canvas, scene, left, right, y, legend_top - 12 * s)
    _draw_legend(canvas, left, right, legend_top)


def _reading(canvas: Any, left: float, right: float, y: float, label: str, value: str) -> float:
    canvas.text((left, y), label, fill=MUTED, font=_font(14))
    canvas.text((right, y), value, fill=INK, font=_font(14), anchor="ra")
    return y + 21 * SUPERSAMPLING


def _bar(canvas: Any, box: tuple[float, float, float, float], share: float, color: Color) -> None:
    left, top, right, bottom = box
    radius = (bottom - top) / 2
    canvas.rounded_rectangle(box, radius=radius, fill=LINE)
    filled = left + (right - left) * min(max(share, 0.0), 1.0)
    if filled - left > 2 * radius:
        canvas.rounded_rectangle((left, top, filled, bottom), radius=radius, fill=color)


def _draw_batteries(canvas: Any, scene: Scene, left: float, right: float, y: float, bottom: float) -> None:
    s = SUPERSAMPLING
    uavs = len(scene.soc)
    rows = min(uavs, PANEL_ROWS_MAX, max(int((bottom - y - 22 * s) / (14 * s)), 0))
    if rows == 0:
        return
    canvas.text((left, y), "Batteries" if rows == uavs else f"Batteries ({rows} lowest)", fill=MUTED, font=_font(14))
    y += 23 * s
    pitch = min((bottom - y) / rows, 20 * s)
    chosen = range(uavs) if rows == uavs else np.argsort(scene.soc, kind="stable")[:rows].tolist()
    for uav in chosen:
        middle = y + pitch / 2
        canvas.text((left + 16 * s, middle), str(uav), fill=INK, font=_font(12), anchor="rm")
        soc = float(scene.soc[uav])
        _bar(canvas, (left + 24 * s, middle - 4 * s, right - 42 * s, middle + 4 * s), soc, _battery_color(soc))
        canvas.text((right, middle), f"{100 * soc:.0f} %", fill=INK, font=_font(12), anchor="rm")
        y += pitch


def _draw_legend(canvas: Any, left: float, right: float, y: float) -> None:
    s = SUPERSAMPLING
    canvas.text((left, y), "communicate", fill=MUTED, font=_font(12))
    canvas.text((right, y), "sense", fill=MUTED, font=_font(12), anchor="ra")
    y += 18 * s
    steps = 48
    for step in range(steps):
        x = left + (right - left) * step / steps
        color = _ramp(PILOT_RAMP, step / (steps - 1))
        canvas.rectangle((x, y, x + (right - left) / steps + 1, y + 7 * s), fill=color)
    y += 22 * s
    entries = (("undetected", UNSEEN), ("confirmed", CONFIRMED), ("informed", INFORMED))
    for place, (label, color) in enumerate(entries):
        x = left + (right - left) * place / 2.9
        _circle(canvas, (x + 5 * s, y + 8 * s), 5 * s, fill=color)
        canvas.text((x + 14 * s, y), label, fill=INK, font=_font(12))
    y += 20 * s
    canvas.text((left, y), "ring: battery   white dot: returning", fill=MUTED, font=_font(12))
