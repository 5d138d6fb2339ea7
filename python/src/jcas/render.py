"""Draws a mission: a map of the fleet and a panel of its state, as an RGB array.

The parts that do not change during a mission are drawn once and cached (`_background`). Moving
parts are pasted onto a copy from cached sprites (`jcas.sprites`), so a frame takes
milliseconds.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .errors import MissingDependencyError

if TYPE_CHECKING:
    from .scene import Scene

MAP_SIDE_PX = 672
MARGIN_PX = 24
PANEL_PX = 296
HEIGHT_MIN_PX = 720
PANEL_ROWS_MAX = 20
LEGEND_PX = 158
LEGEND_ROW_PX = 17
APART_CELLS_MIN, APART_PX_MIN = 0.28, 9.0
"""Least distance between UAVs of one cell. Many UAVs reach over the cell's edge."""
NUMBERED_COUNT_MAX = 12
"""At most this many UAVs of one cell are drawn with their numbers."""
APART_COUNT_MAX = 25
"""More UAVs than this in one cell are drawn as one disc with their number."""

SENSING_ALPHA = 36

Point = tuple[float, float]
Box = tuple[int, int, int, int]


def draw(scene: Scene) -> npt.NDArray[np.uint8]:
    """Draw a scene as an array of shape [height, width, 3]."""
    try:
        from PIL import Image, ImageDraw  # noqa: F401
    except ImportError as error:
        raise MissingDependencyError("Pillow", "rendering", "render") from error
    plan = _Plan(scene)
    depots = tuple(map(tuple, scene.depots.tolist()))
    image = _background(scene.grid_width, scene.grid_height, depots, scene.searched_by).copy()
    _shade(image, plan)
    _draw_ground(image, plan)
    _draw_trail(image, plan)
    for number, (x, y) in enumerate(scene.hotspots.tolist()):
        _draw_hotspot(image, plan, number, plan.centre(x, y))
    _draw_links(image, plan)
    _draw_fleet(image, plan)
    _draw_panel(image, plan)
    return np.asarray(image, dtype=np.uint8).copy()


def cell_side_px(width: int, height: int) -> int:
    """Side of a cell in the picture."""
    return max(4, MAP_SIDE_PX // max(width, height))


class _Plan:
    """The positions of a scene's cells and UAVs in the picture, in pixels."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.cell = cell_side_px(scene.grid_width, scene.grid_height)
        self.left = self.top = MARGIN_PX
        self.width = self.cell * scene.grid_width
        self.height = self.cell * scene.grid_height
        self.members: dict[tuple[int, int], list[int]] = {}
        for uav, (x, y) in enumerate(scene.cells.tolist()):
            self.members.setdefault((x, y), []).append(uav)
        self.positions: list[Point] = [(0.0, 0.0)] * len(scene.cells)
        self.radii = [0.0] * len(scene.cells)
        for place, uavs in self.members.items():
            self._spread(self.centre(*place), uavs)

    def centre(self, x: float, y: float) -> Point:
        """The middle of a cell; y grows upwards on the map."""
        return (
            self.left + (x + 0.5) * self.cell,
            self.top + (self.scene.grid_height - 0.5 - y) * self.cell,
        )

    @property
    def box(self) -> Box:
        """The map in the picture."""
        return self.left, self.top, self.left + self.width, self.top + self.height

    def around(self, points: list[Point], margin: int) -> Box:
        """The part of the map that holds some points, of even sides."""
        xs, ys = zip(*points, strict=True)
        left, top = max(int(min(xs)) - margin, self.left), max(int(min(ys)) - margin, self.top)
        right = min(int(max(xs)) + margin + 1, self.left + self.width)
        bottom = min(int(max(ys)) + margin + 1, self.top + self.height)
        return left, top, right + (right - left) % 2, bottom + (bottom - top) % 2

    def _spread(self, centre: Point, uavs: list[int]) -> None:
        """UAVs of one cell stand in rows, so that each of them is seen."""
        count = len(uavs)
        columns = math.ceil(math.sqrt(count))
        rows = math.ceil(count / columns)
        share = (
            0.56
            if count == 1
            else max(0.94 / columns, APART_CELLS_MIN if count <= NUMBERED_COUNT_MAX else 0)
        )
        apart = max(self.cell * share, APART_PX_MIN)
        for place, uav in enumerate(uavs):
            row, column = divmod(place, columns)
            in_row = min(columns, count - row * columns)
            self.radii[uav] = apart * 0.34
            self.positions[uav] = (
                centre[0] + (column - (in_row - 1) / 2) * apart,
                centre[1] + (row - (rows - 1) / 2) * apart,
            )
            if count > APART_COUNT_MAX:
                self.positions[uav] = centre


@lru_cache(8)
def _background(
    width: int, height: int, depots: tuple[tuple[int, int], ...], searched_by: str
) -> Any:
    """Draw the parts that never change: paper, frame, names of readings, legend."""
    from PIL import Image, ImageDraw

    from . import sprites

    side = cell_side_px(width, height)
    size = (
        side * width + 2 * MARGIN_PX + PANEL_PX,
        max(side * height + 2 * MARGIN_PX, HEIGHT_MIN_PX),
    )
    image = Image.new("RGB", size, sprites.PAPER)
    frame = (
        MARGIN_PX - 3,
        MARGIN_PX - 3,
        MARGIN_PX + side * width + 3,
        MARGIN_PX + side * height + 3,
    )
    ImageDraw.Draw(image).rounded_rectangle(
        frame, radius=7, fill=sprites.WHITE, outline=sprites.LINE
    )
    left = MARGIN_PX + side * width + MARGIN_PX
    _draw_legend(
        image, left, left + PANEL_PX - MARGIN_PX, size[1] - MARGIN_PX - LEGEND_PX, searched_by
    )
    return image


def _shade(image: Any, plan: _Plan) -> None:
    """Tint the searched cells and the cells within the radars' range."""
    from PIL import Image, ImageDraw

    from . import sprites

    scene = plan.scene
    for x, y, length in _runs(scene.searched[::-1]):
        left, top = plan.left + x * plan.cell, plan.top + y * plan.cell
        image.paste(sprites.SEARCHED, (left, top, left + length * plan.cell, top + plan.cell))
    reach = [
        (plan.centre(*cell), float(scene.sensing_range[uavs].max()) * plan.cell)
        for cell, uavs in plan.members.items()
    ]
    ends = [
        (middle[0] + far, middle[1] + far)
        for middle, radius in reach
        if radius > 0
        for far in (-radius, radius)
    ]
    if ends:
        left, top, right, bottom = plan.around(ends, 2)
        mask = Image.new("L", ((right - left) // 2, (bottom - top) // 2))
        canvas = ImageDraw.Draw(mask)
        for (across, down), radius in reach:
            if radius > 0:
                _circle(
                    canvas, ((across - left) / 2, (down - top) / 2), radius / 2, fill=SENSING_ALPHA
                )
        mask = mask.resize((right - left, bottom - top), Image.Resampling.BILINEAR)
        image.paste(sprites.SENSING, (left, top, right, bottom), mask)


def _runs(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Stretches of set flags, row by row: (column, row, length)."""
    padded = np.zeros((flags.shape[0], flags.shape[1] + 2), np.int8)
    padded[:, 1:-1] = flags
    edges = np.diff(padded, axis=1)
    rows, begins = np.nonzero(edges == 1)
    ends = np.nonzero(edges == -1)[1]
    return list(zip(begins.tolist(), rows.tolist(), (ends - begins).tolist(), strict=True))


def _circle(canvas: Any, centre: Point, radius: float, **style: Any) -> None:
    canvas.ellipse(
        (centre[0] - radius, centre[1] - radius, centre[0] + radius, centre[1] + radius), **style
    )


def _draw_ground(image: Any, plan: _Plan) -> None:
    from PIL import ImageDraw

    from . import sprites

    canvas = ImageDraw.Draw(image)
    left, top, right, bottom = plan.box
    if plan.cell >= 12:
        for column in range(1, plan.scene.grid_width):
            x = left + column * plan.cell
            canvas.line((x, top, x, bottom), fill=sprites.LINE)
        for row in range(1, plan.scene.grid_height):
            y = top + row * plan.cell
            canvas.line((left, y, right, y), fill=sprites.LINE)
    for x, y in plan.scene.depots.tolist():
        sprites.put(image, sprites.depot(float(plan.cell)), plan.centre(x, y))


def _draw_trail(image: Any, plan: _Plan) -> None:
    from PIL import ImageDraw

    from . import sprites

    canvas = ImageDraw.Draw(image, "RGBA")
    steps = [*plan.scene.trail, plan.scene.cells]
    for age in range(1, len(steps)):
        moves = {
            (*before, *after)
            for before, after in zip(steps[age - 1].tolist(), steps[age].tolist(), strict=True)
        }
        alpha = round(40 + 130 * age / len(steps))
        for x, y, to_x, to_y in moves:
            if (x, y) != (to_x, to_y):
                ends = (*plan.centre(x, y), *plan.centre(to_x, to_y))
                canvas.line(ends, fill=(*sprites.DEPOT, alpha), width=max(2, plan.cell // 18))


def _draw_hotspot(image: Any, plan: _Plan, number: int, centre: Point) -> None:
    from . import sprites

    scene = plan.scene
    informed, confirmed = bool(scene.informed[number]), bool(scene.confirmed[number])
    color = (
        sprites.INFORMED if informed else sprites.CONFIRMED if confirmed else sprites.UNCONFIRMED
    )
    knowing = (
        round(float(scene.share_knowing[number]) * sprites.SOC_LEVELS)
        if confirmed and not informed
        else 0
    )
    sprites.put(image, sprites.hotspot(max(plan.cell * 0.46, 4.0), color, knowing), centre)


def _draw_links(image: Any, plan: _Plan) -> None:
    """Draw the links between UAVs of different cells, at twice the size for smooth edges."""
    from PIL import Image, ImageDraw

    from . import sprites

    cells = [tuple(cell) for cell in plan.scene.cells.tolist()]
    pairs = np.argwhere(np.triu(plan.scene.links, 1)).tolist()
    lines = [(plan.positions[i], plan.positions[j]) for i, j in pairs if cells[i] != cells[j]]
    if not lines:
        return
    left, top, right, bottom = plan.around([end for line in lines for end in line], 3)
    mask = Image.new("L", (2 * (right - left), 2 * (bottom - top)))
    canvas = ImageDraw.Draw(mask)
    for (x, y), (to_x, to_y) in lines:
        canvas.line(
            [2 * (x - left), 2 * (y - top), 2 * (to_x - left), 2 * (to_y - top)], fill=150, width=3
        )
    image.paste(sprites.LINK, (left, top, right, bottom), mask.reduce(2))


def _draw_fleet(image: Any, plan: _Plan) -> None:
    from . import sprites

    scene = plan.scene
    span = max(scene.pilot_density_max - scene.pilot_density_min, 1e-9)
    shares = ((scene.pilot_density - scene.pilot_density_min) / span).tolist()
    charges, grounded, returning = (
        scene.soc.tolist(),
        scene.grounded.tolist(),
        scene.returning.tolist(),
    )
    for uavs in plan.members.values():
        if len(uavs) > APART_COUNT_MAX:
            color = sprites.ramp(sprites.PILOT_RAMP, sum(shares[uav] for uav in uavs) / len(uavs))
            sprites.put_crowd(
                image, plan.positions[uavs[0]], max(plan.cell * 0.42, 10.0), color, len(uavs)
            )
            continue
        for uav in uavs:
            radius = plan.radii[uav]
            color = (
                sprites.GROUNDED if grounded[uav] else sprites.ramp(sprites.PILOT_RAMP, shares[uav])
            )
            label = str(uav) if radius >= 4.0 and uav < 100 else ""
            sprites.put_uav(
                image, plan.positions[uav], radius, color, charges[uav], returning[uav], label
            )


def _draw_panel(image: Any, plan: _Plan) -> None:
    from . import sprites

    scene = plan.scene
    left = plan.left + plan.width + MARGIN_PX
    right = left + PANEL_PX - MARGIN_PX
    y = plan.top
    sprites.write(image, (left, y), f"Step {scene.t} of {scene.horizon_steps}", 21, sprites.INK)
    if scene.outcome:
        color = sprites.INFORMED if scene.outcome == "success" else sprites.LOW
        sprites.write(image, (right, y + 5), scene.outcome, 15, color, "ra")
    y += 33
    _bar(
        image, (left, y, right, y + 6), scene.t / max(scene.horizon_steps, 1), sprites.COMMUNICATING
    )
    y += 20
    total = len(scene.hotspots)
    for label, marks, color in (
        ("Confirmed", scene.confirmed, sprites.CONFIRMED),
        ("Informed", scene.informed, sprites.INFORMED),
    ):
        done = int(marks.sum())
        y = _reading(image, left, right, y, label, f"{done} / {total}")
        _bar(image, (left, y, right, y + 6), done / max(total, 1), color)
        y += 14
    for label, value in scene.readings:
        y = _reading(image, left, right, y, label, value)
    legend_top = image.height - MARGIN_PX - LEGEND_PX
    _draw_batteries(image, scene, left, right, y + 6, legend_top - 10)


def _reading(image: Any, left: int, right: int, y: int, label: str, value: str) -> int:
    from . import sprites

    sprites.write(image, (left, y), label, 14, sprites.MUTED)
    sprites.write(image, (right, y), value, 14, sprites.INK, "ra")
    return y + 21


def _bar(image: Any, box: Box, share: float, color: Any) -> None:
    from . import sprites

    left, top, right, bottom = box
    filled = left + round((right - left) * min(max(share, 0.0), 1.0))
    image.paste(sprites.LINE, (filled, top, right, bottom))
    image.paste(color, (left, top, filled, bottom))


def _draw_batteries(image: Any, scene: Scene, left: int, right: int, y: int, bottom: int) -> None:
    from . import sprites

    uavs = len(scene.soc)
    rows = min(uavs, PANEL_ROWS_MAX, max((bottom - y - 20) // 13, 0))
    if rows == 0:
        return
    title = "Batteries" if rows == uavs else f"Batteries ({rows} lowest)"
    sprites.write(image, (left, y), title, 14, sprites.MUTED)
    y += 22
    pitch = min((bottom - y) / rows, 18.0)
    chosen = range(uavs) if rows == uavs else np.argsort(scene.soc, kind="stable")[:rows].tolist()
    for row, uav in enumerate(chosen):
        middle = round(y + (row + 0.5) * pitch)
        soc = float(scene.soc[uav])
        sprites.write(image, (left + 16, middle), str(uav), 12, sprites.INK, "rm")
        _bar(
            image, (left + 24, middle - 3, right - 42, middle + 4), soc, sprites.battery_color(soc)
        )
        sprites.write(image, (right, middle), f"{100 * soc:.0f} %", 12, sprites.INK, "rm")


def _draw_legend(image: Any, left: int, right: int, y: int, searched_by: str) -> None:
    from PIL import ImageDraw

    from . import sprites

    sprites.write(image, (left, y), "communicates", 12, sprites.MUTED)
    sprites.write(image, (right, y), "senses", 12, sprites.MUTED, "ra")
    y += 17
    for x in range(left, right):
        color = sprites.ramp(sprites.PILOT_RAMP, (x - left) / (right - left - 1))
        image.paste(color, (x, y, x + 1, y + 7))
    y += 19
    canvas = ImageDraw.Draw(image)
    half, middle = sprites.SOC_LEVELS // 2, sprites.ramp(sprites.PILOT_RAMP, 0.5)
    symbols: list[tuple[str, Any]] = [
        ("unconfirmed", sprites.hotspot(6.0, sprites.UNCONFIRMED, 0)),
        ("confirmed", sprites.hotspot(6.0, sprites.CONFIRMED, 0)),
        ("informed", sprites.hotspot(6.0, sprites.INFORMED, 0)),
        ("share that knows", sprites.hotspot(6.0, sprites.CONFIRMED, half)),
        ("UAV, ring: battery", ("uav", middle, 0.7, False)),
        ("UAV returning", ("uav", middle, 0.7, True)),
        ("UAV grounded", ("uav", sprites.GROUNDED, 0.0, False)),
        ("depot", sprites.depot(15.0)),
        ("link between cells", ("line", sprites.LINK)),
        ("last moves", ("line", sprites.DEPOT)),
        (
            "detects 1 in 10",
            ("area", sprites.ramp((sprites.WHITE, sprites.SENSING), SENSING_ALPHA / 255)),
        ),
        (searched_by, ("area", sprites.SEARCHED)),
    ]
    for place, (label, symbol) in enumerate(symbols):
        row, column = divmod(place, 2)
        x, middle_y = left + 8 + column * (right - left) // 2, y + 9 + row * LEGEND_ROW_PX
        if not isinstance(symbol, tuple):
            sprites.put(image, symbol, (x, middle_y))
        elif symbol[0] == "uav":
            _, color, soc, returning = symbol
            sprites.put_uav(image, (x, middle_y), 5.0, color, soc, returning, "")
        elif symbol[0] == "line":
            canvas.line((x - 7, middle_y, x + 7, middle_y), fill=symbol[1], width=2)
        else:
            canvas.rectangle(
                (x - 7, middle_y - 5, x + 7, middle_y + 5), fill=symbol[1], outline=sprites.LINE
            )
        sprites.write(image, (x + 14, middle_y), label, 12, sprites.INK, "lm")
