"""What a 3MF file says beside its triangles: the unit, and the names of its objects."""

from __future__ import annotations

import re
import zipfile
from pathlib import Path

_MODEL = "3D/3dmodel.model"
# Millimetres of the units.
_UNITS = {
    "micron": 0.001,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}
_TAG = re.compile(rb"<(?:\w+:)?(model|object|item)\b([^>]*)>")


def read_unit(path: Path) -> float | None:
    """Millimetres of a unit; None where the file has no model at the usual place."""
    model = _model(path)
    if model is None:
        return None
    head = _TAG.search(model)
    unit = _attribute(head[2], b"unit") if head and head[1] == b"model" else ""
    return _UNITS.get(unit or "millimeter")


def object_names(path: Path) -> list[str]:
    """The names of the objects that are built, each time they are: the host's layers."""
    names: dict[str, str] = {}
    built: list[str] = []
    for tag, attributes in _TAG.findall(_model(path) or b""):
        if tag == b"object":
            names[_attribute(attributes, b"id")] = _attribute(attributes, b"name")
        elif tag == b"item":
            built.append(_attribute(attributes, b"objectid"))
    return [names.get(one) or f"object {i}" for i, one in enumerate(built)]


def _model(path: Path) -> bytes | None:
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.read(_MODEL)
    except (zipfile.BadZipFile, KeyError, OSError):
        return None  # the host says what is wrong, or finds the model elsewhere


def _attribute(attributes: bytes, name: bytes) -> str:
    match = re.search(rb"(?:^|\s)%b\s*=\s*(\"[^\"]*\"|'[^']*')" % name, attributes)
    return match[1][1:-1].decode("utf-8", "replace") if match else ""
