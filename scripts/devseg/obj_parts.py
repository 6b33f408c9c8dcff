"""Objects, groups and materials of the faces of an OBJ file, which the host does not keep."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_NAMES = {
    kind: re.compile(rb"^[ \t]*%b[ \t]+(.*?)\s*$" % kind, re.MULTILINE)
    for kind in (b"o", b"g", b"usemtl")
}


@dataclass(frozen=True)
class Part:
    """Faces of one object, group and material; empty where the file does not say."""

    object: str
    group: str
    material: str


@dataclass(frozen=True)
class NamedFaces:
    """The faces of a file: their parts, and their vertices as far as the parts differ.

    Attributes:
        parts: in the order in which they begin.
        part: of each polygon of the file.
        corners: of each polygon, vertices from 0.
    """

    parts: list[Part]
    part: list[int]
    corners: list[list[int]]


def read(path: Path) -> NamedFaces:
    """Reads names, and the faces where there is more than one part."""
    data = path.read_bytes()
    named = [{*_NAMES[kind].findall(data)} for kind in (b"o", b"g", b"usemtl")]
    if max(map(len, named)) <= 1:
        return NamedFaces([_part(*(one.pop() if one else b"" for one in named))], [], [])
    names = {b"o": b"", b"g": b"", b"usemtl": b""}
    index: dict[tuple[bytes, ...], int] = {}
    part: list[int] = []
    corners: list[list[int]] = []
    vertices = 0
    for line in data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines():
        words = line.split(None, 1)
        if len(words) < 2:
            continue
        kind, rest = words
        if kind == b"v":
            vertices += 1
        elif kind == b"f":
            part.append(index.setdefault(tuple(names.values()), len(index)))
            of_v = (int(word.split(b"/", 1)[0]) for word in rest.split())
            corners.append([i - 1 if i > 0 else vertices + i for i in of_v])
        elif kind in names:
            names[kind] = rest.strip()
            if kind == b"o":
                names[b"g"] = b""  # groups are parts of objects
    return NamedFaces([_part(*key) for key in index], part, corners)


def _part(*names: bytes) -> Part:
    return Part(*(name.decode("utf-8", "replace") for name in names))


def parts_of_faces(named: NamedFaces, faces: Any) -> Any:
    """The part of each triangle that the host made of the polygons, in their order.

    Args:
        named: the polygons.
        faces: #F by 3, vertices as in the file.

    Returns:
        #F numbers; None where the triangles are not those of the polygons.
    """
    import numpy as np

    if len(named.parts) == 1:
        return np.zeros(len(faces))
    triangles = [max(len(polygon) - 2, 0) for polygon in named.corners]
    if sum(triangles) == len(faces):
        return np.repeat(np.array(named.part, dtype=float), triangles)
    # The host leaves out triangles that repeat a vertex.
    found = np.empty(len(faces))
    at = 0
    rows = faces.tolist()
    for part, polygon, most in zip(named.part, named.corners, triangles, strict=True):
        inside = set(polygon)
        end = min(at + most, len(rows))
        while at < end and inside.issuperset(rows[at]):
            found[at] = part
            at += 1
    return found if at == len(rows) else None
