"""What a file says about its unit of length and about the direction that points up."""

from __future__ import annotations

import re
import zipfile
from dataclasses import dataclass
from pathlib import Path

from devseg import gltf

# Millimetres of the units that 3MF knows.
_3MF_UNITS = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}
_3MF_MODEL = "3D/3dmodel.model"
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
        return Frame(_unit_of_3mf(path), "z")
    if extension == ".dae":
        return _frame_of_collada(path)
    return Frame()


def _unit_of_3mf(path: Path) -> float | None:
    try:
        with zipfile.ZipFile(path) as archive, archive.open(_3MF_MODEL) as file:
            head = file.read(_HEAD)
    except (zipfile.BadZipFile, KeyError, OSError):
        return None  # the host says what is wrong, or finds the model elsewhere
    model = re.search(rb"<(?:\w+:)?model\b[^>]*>", head)
    unit = re.search(rb"\bunit\s*=\s*[\"'](\w+)", model[0]) if model else None
    return _3MF_UNITS.get(unit[1].decode() if unit else "millimeter")


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
