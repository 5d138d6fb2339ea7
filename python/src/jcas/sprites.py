"""Small pictures that a map is put together from, drawn once and kept.

Each is drawn larger than it will be shown and reduced, which smooths its edges.
"""

from __future__ import annotations

import math
from functools import cache, lru_cache
from typing import Any

from PIL import Image, ImageDraw, ImageFont

Color = tuple[int, int, int]

SMOOTHING = 4

INK = (31, 41, 55)
MUTED = (110, 120, 135)
PAPER = (246, 247, 250)
WHITE = (255, 255, 255)
LINE = (228, 232, 239)
GROUNDED = (148, 155, 166)
SEARCHED = (223, 233, 247)
# What follows has the colours of the replay page.
COMMUNICATING = (31, 105, 201)
SENSING = (224, 123, 0)
LINK = COMMUNICATING
DEPOT = (98, 110, 132)
UNCONFIRMED = (156, 63, 122)
CONFIRMED = (194, 37, 122)
INFORMED = (10, 125, 89)
BATTERY = (61, 74, 97)
LOW = (207, 42, 42)
PILOT_RAMP = (COMMUNICATING, SENSING)
SOC_LEVELS = 32


def ramp(stops: tuple[Color, ...], share: float) -> Color:
    """Blend a color out of evenly spaced ones."""
    place = min(max(share, 0.0), 1.0) * (len(stops) - 1)
    low = min(int(place), len(stops) - 2)
    rest = place - low
    red, green, blue = (
        round(a + (b - a) * rest) for a, b in zip(stops[low], stops[low + 1], strict=True)
    )
    return red, green, blue


def battery_color(soc: float) -> Color:
    """Red where a battery is nearly empty."""
    return ramp((LOW, BATTERY), (soc - 0.15) / 0.15)


def put(image: Any, what: Any, centre: tuple[float, float], mask: Any = None) -> None:
    """Paste a sprite where its middle belongs, or a color through a mask."""
    shape = what if mask is None else mask
    left, top = round(centre[0] - shape.width / 2), round(centre[1] - shape.height / 2)
    image.paste(what, (left, top, left + shape.width, top + shape.height), shape)


def write(
    image: Any, place: tuple[float, float], text: str, size: float, color: Color, anchor: str = "la"
) -> None:
    """Write a text; anchors are Pillow's."""
    mask = _text(text, size)
    x, y = place
    x -= {"l": 0.0, "m": mask.width / 2, "r": float(mask.width)}[anchor[0]]
    y -= {"a": 0.0, "m": mask.height / 2}[anchor[1]]
    image.paste(color, (round(x), round(y), round(x) + mask.width, round(y) + mask.height), mask)


@cache
def _font(size: float) -> Any:
    return ImageFont.load_default(size)


@lru_cache(4096)
def _text(text: str, size: float) -> Any:
    font = _font(size)
    ascent, descent = font.getmetrics()
    mask = Image.new("L", (max(int(font.getlength(text)) + 2, 1), ascent + descent))
    ImageDraw.Draw(mask).text((0, 0), text, fill=255, font=font)
    return mask


def _board(side: float, mode: str = "RGBA") -> tuple[Any, Any, float]:
    """An empty square of an odd number of pixels, something to draw on it with, and its middle."""
    pixels = (2 * int(side / 2 + 1) + 1) * SMOOTHING
    board = Image.new(mode, (pixels, pixels), (*WHITE, 0) if mode == "RGBA" else 0)
    return board, ImageDraw.Draw(board), pixels / 2


def _smoothed(board: Any) -> Any:
    return board.reduce(SMOOTHING)


def _box(middle: float, radius: float) -> tuple[float, float, float, float]:
    return middle - radius, middle - radius, middle + radius, middle + radius


def put_uav(
    image: Any,
    centre: tuple[float, float],
    radius: float,
    color: Color,
    soc: float,
    returning: bool,
    label: str,
) -> None:
    """Draw a UAV: a colored disc in a battery ring, with a number, or a dot while it returns."""
    put(image, _ring(radius, math.ceil(min(max(soc, 0.0), 1.0) * SOC_LEVELS)), centre)
    put(image, color, centre, _disc(radius))
    if returning:
        put(image, WHITE, centre, _disc(radius * 0.42))
    elif label:
        write(image, centre, label, radius * (1.25 if len(label) < 2 else 1.05), WHITE, "mm")


def put_crowd(
    image: Any, centre: tuple[float, float], radius: float, color: Color, count: int
) -> None:
    """Draw more UAVs than a cell has room for: one disc with their number."""
    put(image, WHITE, centre, _disc(radius + 1.5))
    put(image, color, centre, _disc(radius))
    write(image, centre, str(count), radius * (1.1 if count < 100 else 0.8), WHITE, "mm")


@lru_cache(64)
def _disc(radius: float) -> Any:
    board, canvas, middle = _board(2 * radius + 2, "L")
    canvas.ellipse(_box(middle, radius * SMOOTHING), fill=255)
    return _smoothed(board)


@lru_cache(2048)
def _ring(radius: float, soc_level: int) -> Any:
    outer = radius * 1.38
    board, canvas, middle = _board(2 * outer + 2)
    s = SMOOTHING
    thickness = max(round(radius * 0.26 * s), s)
    canvas.ellipse(_box(middle, (outer + 0.8) * s), fill=WHITE)
    canvas.arc(_box(middle, outer * s), 0, 360, fill=LINE, width=thickness)
    if soc_level:
        soc = soc_level / SOC_LEVELS
        canvas.arc(
            _box(middle, outer * s), -90, -90 + 360 * soc, fill=battery_color(soc), width=thickness
        )
    return _smoothed(board)


@lru_cache(256)
def hotspot(half: float, color: Color, knowing_level: int) -> Any:
    """Draw a hotspot as a square, dashed until it is confirmed.

    A bar along its bottom shows the fraction of the fleet that knows it.
    """
    board, canvas, middle = _board(2 * half + 4)
    s = SMOOTHING
    h, width = half * 0.88 * s, max(round(half * 0.13 * s), s)
    low, high = middle - h, middle + h
    if color == UNCONFIRMED:
        canvas.rectangle(_box(middle, h), fill=(*color, 40))
        dash = 2 * h / 5
        for start in (low, low + 2 * dash, low + 4 * dash):
            for side in (low, high):
                canvas.line([start, side, start + dash, side], fill=color, width=width)
                canvas.line([side, start, side, start + dash], fill=color, width=width)
    else:
        canvas.rounded_rectangle(
            _box(middle, h), radius=h / 4, fill=(*color, 80), outline=color, width=width
        )
    if knowing_level:
        end = low + 2 * h * knowing_level / SOC_LEVELS
        canvas.line([low, high - width, end, high - width], fill=color, width=2 * width)
    return _smoothed(board)


@lru_cache(16)
def depot(side: float) -> Any:
    """Draw a depot: a square as large as its cell."""
    board, canvas, middle = _board(side)
    s = SMOOTHING
    canvas.rounded_rectangle(
        _box(middle, side * 0.46 * s),
        radius=side * 0.12 * s,
        fill=(*DEPOT, 28),
        outline=(*DEPOT, 150),
        width=max(round(1.5 * s), 1),
    )
    return _smoothed(board)
