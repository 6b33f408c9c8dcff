"""Lengths and pages as people give them on the command line."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Sequence

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, '"': 25.4, "ft": 304.8}

# Sheets of paper, upright, in millimetres.
PAGES = {
    "a0": (841.0, 1189.0),
    "a1": (594.0, 841.0),
    "a2": (420.0, 594.0),
    "a3": (297.0, 420.0),
    "a4": (210.0, 297.0),
    "a5": (148.0, 210.0),
    "letter": (215.9, 279.4),
    "legal": (215.9, 355.6),
    "tabloid": (279.4, 431.8),
}
# The export filter knows these by name.
_KNOWN_TO_FILTER = ("none", "a4", "letter", "a3")
_LONGEST_SIDE = 1e5  # mm; the filter's own limit

_NUMBER = r"(\d+(?:\.\d*)?|\.\d+)"


def number(text: str) -> float:
    """A finite number or NaN."""
    try:
        value = float(text)
    except ValueError:
        return math.nan
    return value if math.isfinite(value) else math.nan


def length(least: float = 0.0) -> Callable[[str], float]:
    """A parser of plain numbers of at least `least`."""

    def parse(text: str) -> float:
        value = number(text)
        if not value >= least:
            raise argparse.ArgumentTypeError(
                f"expected a number of at least {least:g}, found '{text}'"
            )
        return value

    return parse


def millimetres(least: float = 0.0) -> Callable[[str], float]:
    """A parser of lengths of at least `least` mm: a number in mm, or one with its unit."""

    def parse(text: str) -> float:
        value = _with_unit(text, 1.0)
        if not value >= least:
            raise argparse.ArgumentTypeError(
                f"expected a length of at least {least:g} mm such as 6 or 0.25in, found '{text}'"
            )
        return value

    return parse


def size(text: str) -> float:
    """A length above 0 with its unit, in mm."""
    value = _with_unit(text, math.nan)
    if not value > 0:
        raise argparse.ArgumentTypeError(
            f"expected a length with its unit such as 250mm, 25cm or 10in, found '{text}'"
        )
    return value


def _with_unit(text: str, default: float) -> float:
    """Millimetres; NaN for what is no length. `default` is the unit of a number without one."""
    match = re.fullmatch(r"\s*(.*?)\s*(mm|cm|m|in|\"|ft)?\s*", text.lower())
    if not match:
        return math.nan
    return number(match[1]) * (UNITS[match[2]] if match[2] else default)


def page(text: str) -> str:
    """The export filter's word for a page: a name, or width x height in millimetres."""
    name, _, direction = text.lower().partition("-")
    if name in _KNOWN_TO_FILTER and not direction:
        return name
    if name in PAGES and direction in ("", "landscape", "portrait"):
        width, height = PAGES[name]
        return _words(height, width) if direction == "landscape" else _words(width, height)
    match = re.fullmatch(rf"{_NUMBER}\s*x\s*{_NUMBER}\s*(mm|cm|m|in|ft)?", text.lower())
    if match:
        sides = [float(match[k]) * UNITS[match[3] or "mm"] for k in (1, 2)]
        if min(sides) > 0 and max(sides) <= _LONGEST_SIDE:
            return _words(*sides)
    raise argparse.ArgumentTypeError(
        f"expected none, {', '.join(PAGES)} (each also with -landscape), or width x height such as "
        f"600x400 (mm) or 24x36in, found '{text}'"
    )


def shown(sides: Sequence[float]) -> str:
    """A size for people: four digits, and no powers of ten."""
    return " x ".join(f"{s:,.0f}" if s >= 1000 else f"{s:.4g}" for s in sides) + " mm"


def _words(width: float, height: float) -> str:
    return f"{width:.10g}x{height:.10g}"
