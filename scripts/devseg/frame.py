"""What a file says about its unit of length and about the direction that points up."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from devseg import gltf, threemf

# Both stand near the beginning.
_HEAD = 1 << 16

# Columns are x, y, z of the file in the frame whose y points up; a rotation about x, exact in
# floating point, as is its transpose.
UPRIGHT = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
}


@dataclass(frozen=True)
class Frame:
    """The frame of a file; None where the format does not say.

    Attributes:
        mm_per_unit: millimetres of a unit.
        up: the axis that points up, y or z.
    """

    mm_per_unit: float | None = None
    up: str | None = None


def read_frame(path: Path) -> Frame:
    """The frame of a file, whose format is known by its extension."""
    extension = path.suffix.lower()
    if extension in gltf.EXTENSIONS:
        return Frame(1000.0, "y")  # both are fixed by the format
    if extension == ".3mf":
        return Frame(threemf.read_unit(path), "z")
    if extension == ".dae":
        return _frame_of_collada(path)
    return Frame()


def _frame_of_collada(path: Path) -> Frame:
    with path.open("rb") as file:
        head = file.read(_HEAD)
    meter = re.search(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([^\"']+)", head)
    up = re.search(rb"<up_axis>\s*([XYZ])_UP", head)
    try:
        mm = 1000.0 * float(meter[1]) if meter else 1000.0  # metre unless it says otherwise
    except ValueError:
        mm = 0.0
    axis = up[1].decode().lower() if up else "y"
    return Frame(mm if mm > 0 else None, axis if axis in UPRIGHT else None)
