"""What a 3MF file says beside its triangles: the unit, and names of objects and materials."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_DEEPEST = 16  # components within each other; a file may name itself

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
# A triangle that names a corner twice.
_REPEATED = re.compile(
    rb"<(?:\w+:)?triangle\s[^>]*?"
    rb'(?:v1="(\d+)"\s+v2="\1"|v2="(\d+)"\s+v3="\2"|v1="(\d+)"\s+v2="\d+"\s+v3="\3")[^>]*/>'
)
_TAG = re.compile(rb"<(?:\w+:)?(model)\b([^>]*)>")


def read_unit(path: Path) -> float | None:
    """Millimetres of a unit; None where the file has no model at the usual place."""
    model = _model(path)
    if model is None:
        return None
    head = _TAG.search(model)
    unit = _attribute(head[2], b"unit") if head else ""
    return _UNITS.get(unit or "millimeter")


def rewritten(path: Path, folder: Path) -> tuple[Path, list[str]]:
    """The file, or one without triangles that name a corner twice: the host reads no others.

    Args:
        path: of the file.
        folder: for another one.

    Returns:
        The file to read, and what it leaves out.
    """
    import zipfile

    try:
        with zipfile.ZipFile(path) as archive:
            parts = {name: archive.read(name) for name in archive.namelist()}
    except (zipfile.BadZipFile, OSError):
        return path, []  # the host says what is wrong
    left_out = 0
    for name, part in parts.items():
        if name.endswith(".model"):
            parts[name], count = _REPEATED.subn(b"", part)
            left_out += count
    if left_out == 0:
        return path, []
    copy = folder / path.name
    with zipfile.ZipFile(copy, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, part in parts.items():
            archive.writestr(name, part)
    return copy, [f"{left_out} triangles name a corner twice and were left out"]


@dataclass(frozen=True)
class Run:
    """Triangles of one material that follow each other.

    Attributes:
        material: its name; empty without one.
        triangles: their number.
    """

    material: str
    triangles: int


@dataclass(frozen=True)
class Built:
    """An object that is built.

    Attributes:
        name: of the object.
        runs: its triangles.
    """

    name: str
    runs: list[Run]


def built(path: Path) -> list[Built]:
    """The objects that are built, each time they are: the host's layers."""
    model = _tree(path)
    if model is None:
        return []
    materials = _material_names(model)
    objects = {_text(o, "id"): o for o in model.iter() if _kind(o) == "object"}
    found: list[Built] = []
    for item in model.iter():
        one = objects.get(_text(item, "objectid")) if _kind(item) == "item" else None
        if one is not None:
            name = _text(one, "name") or f"object {len(found)}"
            found.append(Built(name, _runs(one, objects, materials, 0)))
    return found


def material_colors(path: Path) -> dict[str, tuple[float, float, float]]:
    """Red, green and blue of each material by its name."""
    colors = {}
    model = _tree(path)
    for base in model.iter() if model is not None else ():
        color = _text(base, "displaycolor").lstrip("#")
        if _kind(base) == "base" and re.fullmatch(r"[0-9a-fA-F]{6,8}", color):
            red, green, blue = (int(color[k : k + 2], 16) / 255 for k in (0, 2, 4))
            colors[_text(base, "name")] = (red, green, blue)
    return colors


def _material_names(model: Element) -> dict[tuple[str, int], str]:
    """Names by the group and the place in it."""
    groups = [group for group in model.iter() if _kind(group) == "basematerials"]
    return {(_text(g, "id"), k): _text(base, "name") for g in groups for k, base in enumerate(g)}


def _runs(
    one: Element, objects: dict[str, Element], materials: dict[tuple[str, int], str], depth: int
) -> list[Run]:
    if depth > _DEEPEST:
        return []
    runs: list[Run] = []
    own = _text(one, "pid"), _text(one, "pindex") or "0"
    for part in one.iter():
        if _kind(part) == "component" and (other := objects.get(_text(part, "objectid"))):
            runs += _runs(other, objects, materials, depth + 1)
        if _kind(part) != "triangle" or len({part.get(f"v{k}") for k in (1, 2, 3)}) < 3:
            continue
        get = part.get
        group = get("pid", own[0])
        index = get("p1", own[1] if group == own[0] else "0")
        name = materials.get((group, int(index)), "") if index.isdecimal() else ""
        if runs and runs[-1].material == name:
            runs[-1] = Run(name, runs[-1].triangles + 1)
        else:
            runs.append(Run(name, 1))
    return runs


def _tree(path: Path) -> Element | None:
    from xml.etree.ElementTree import ParseError, fromstring

    model = _model(path)
    try:
        return fromstring(model) if model else None
    except ParseError:
        return None  # the host says what is wrong


def _kind(element: Element) -> str:
    return element.tag.rpartition("}")[2]


def _text(element: Element, name: str) -> str:
    return element.get(name, "")


def _model(path: Path) -> bytes | None:
    import zipfile

    try:
        with zipfile.ZipFile(path) as archive:
            return archive.read(_MODEL)
    except (zipfile.BadZipFile, KeyError, OSError):
        return None  # the host says what is wrong, or finds the model elsewhere


def _attribute(attributes: bytes, name: bytes) -> str:
    match = re.search(rb"(?:^|\s)%b\s*=\s*(\"[^\"]*\"|'[^']*')" % name, attributes)
    return match[1][1:-1].decode("utf-8", "replace") if match else ""
