"""What a 3DS file says beside its triangles: the materials of its faces.

The host takes the names of objects from it, and leaves their materials out.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

# Chunks: a number, the bytes that they have with what is in them, and what is in them.
_HEAD = struct.Struct("<HI")
_MAIN, _EDITOR, _OBJECT, _MESH = 0x4D4D, 0x3D3D, 0x4000, 0x4100
_FACES, _FACE_MATERIAL = 0x4120, 0x4130
_MATERIAL, _NAME, _DIFFUSE = 0xAFFF, 0xA000, 0xA020
_COLOR_FLOATS, _COLOR_BYTES = (0x0010, 0x0013), (0x0011, 0x0012)
_CORNERS = 8  # bytes of a face: three corners and its flags


@dataclass(frozen=True)
class Object:
    """Triangles of the file.

    Attributes:
        name: of the object.
        materials: the name of each triangle's material; empty without one.
    """

    name: str
    materials: list[str]


def objects(path: Path) -> list[Object]:
    """The objects that have triangles; as many as can be understood."""
    data = path.read_bytes()
    found = []
    for at, end in _inside(data, 0, len(data), _MAIN, _EDITOR, _OBJECT):
        name, at = _text(data, at, end)
        found += [
            Object(name, _materials(data, *faces))
            for faces in _inside(data, at, end, _MESH, _FACES)
        ]
    return [one for one in found if one.materials]


def runs_of_layers(path: Path, layers: Sequence[tuple[str, int]]) -> list[list[tuple[str, int]]]:
    """Materials of the layers' faces, as runs of a name and a number; empty where not known.

    Args:
        path: the file.
        layers: name and number of faces of what the host made, cameras without faces included.
    """
    found = objects(path)
    with_faces = [count for _, count in layers if count]
    if [len(one.materials) for one in found] == with_faces:
        # The host's names are those of other objects where there are cameras.
        following = iter(found)
        matching = [next(following).materials if count else [] for _, count in layers]
    else:
        named = {(one.name, len(one.materials)): one.materials for one in found}
        matching = [named.get(layer, []) for layer in layers]
    return [[(name, len(list(run))) for name, run in groupby(names)] for names in matching]


def material_colors(path: Path) -> dict[str, tuple[float, float, float]]:
    """Red, green and blue of each material by its name, as far as the file tells them."""
    data = path.read_bytes()
    colors = {}
    for at, end in _inside(data, 0, len(data), _MAIN, _EDITOR, _MATERIAL):
        names = [_text(data, *place)[0] for place in _inside(data, at, end, _NAME)]
        for place in _inside(data, at, end, _DIFFUSE):
            color = _color(data, *place)
            if names and color is not None:
                colors[names[0]] = color
    return colors


def _chunks(data: bytes, at: int, end: int) -> Iterator[tuple[int, int, int]]:
    """Number, begin and end of the chunks that follow each other."""
    while at + _HEAD.size <= end:
        kind, size = _HEAD.unpack_from(data, at)
        if size < _HEAD.size or at + size > end:
            return
        yield kind, at + _HEAD.size, at + size
        at += size


def _inside(data: bytes, at: int, end: int, *kinds: int) -> Iterator[tuple[int, int]]:
    """Begin and end of the chunks of the last kind in those of the kinds before."""
    for kind, begin, stop in _chunks(data, at, end):
        if kind == kinds[0]:
            yield from _inside(data, begin, stop, *kinds[1:]) if kinds[1:] else [(begin, stop)]


def _text(data: bytes, at: int, end: int) -> tuple[str, int]:
    """A text that ends with a zero, and where it ends."""
    stop = data.find(b"\0", at, end)
    stop = end if stop < 0 else stop
    return data[at:stop].decode("utf-8", "replace"), min(stop + 1, end)


def _whole_numbers(data: bytes, at: int, end: int) -> tuple[int, ...]:
    """A number of 16 bits, and as many more; fewer where the chunk ends."""
    if at + 2 > end:
        return ()
    count = min(int.from_bytes(data[at : at + 2], "little"), (end - at - 2) // 2)
    return struct.unpack_from(f"<{count}H", data, at + 2)


def _materials(data: bytes, at: int, end: int) -> list[str]:
    """The material of each face of a mesh."""
    if at + 2 > end:
        return []
    count = int.from_bytes(data[at : at + 2], "little")
    names = [""] * count
    for begin, stop in _inside(data, at + 2 + _CORNERS * count, end, _FACE_MATERIAL):
        name, begin = _text(data, begin, stop)
        for face in _whole_numbers(data, begin, stop):
            if face < count:
                names[face] = name
    return names


def _color(data: bytes, at: int, end: int) -> tuple[float, float, float] | None:
    for kind, begin, stop in _chunks(data, at, end):
        if kind in _COLOR_FLOATS and stop - begin >= 12:
            red, green, blue = struct.unpack_from("<3f", data, begin)
            return red, green, blue
        if kind in _COLOR_BYTES and stop - begin >= 3:
            red, green, blue = (value / 255 for value in data[begin : begin + 3])
            return red, green, blue
    return None
