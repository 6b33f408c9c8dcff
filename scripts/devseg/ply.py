"""What the host does not do about PLY files.

It believes a header that promises more than the file holds, and fills the memory. It writes custom
face attributes, but does not read them back. It goes on naming textures of other coordinates.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg.errors import DevsegError, one_line

if TYPE_CHECKING:
    import numpy as np

ATTRIBUTES = ("chart_id", "seam_edges")

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_LONGEST_HEADER = 1 << 16
_PART = re.compile(r"comment part_id \d+: (.*)")


@dataclass(frozen=True)
class _Property:
    name: str
    type: str
    # The type of a list's length, empty for a scalar.
    length_type: str = ""


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list[_Property]

    def least_size(self, binary: bool) -> int:
        """Bytes that one row takes at least: lists may be empty, a number in text takes two."""
        if not binary:
            return 2 * len(self.properties)
        return sum(int((p.length_type or p.type)[1:]) for p in self.properties)


@dataclass(frozen=True)
class _Header:
    order: str  # "<", ">" or "" for text
    size: int
    elements: list[_Element]


def _read_header(path: Path) -> _Header | None:
    """The header; None where it is not one that this module understands."""
    with path.open("rb") as file:
        head = file.read(_LONGEST_HEADER)
    end = head.find(b"end_header")
    size = head.find(b"\n", end) + 1
    if not head.startswith(b"ply") or end < 0 or size == 0:
        return None
    order = ""
    elements: list[_Element] = []
    try:
        for line in head[:end].decode("ascii", errors="replace").splitlines():
            match line.split():
                case ["format", name, *_]:
                    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(name, "")
                case ["element", name, count]:
                    elements.append(_Element(name, int(count), []))
                case ["property", "list", length, item, name]:
                    elements[-1].properties.append(_Property(name, _TYPES[item], _TYPES[length]))
                case ["property", item, name]:
                    elements[-1].properties.append(_Property(name, _TYPES[item]))
    except (ValueError, KeyError, IndexError):
        return None
    return _Header(order, size, elements)


def check_size(path: Path) -> None:
    """Refuses a file that is too short for what its header promises.

    Raises:
        DevsegError: with both sizes.
    """
    header = _read_header(path)
    if header is None:
        return
    needed = header.size + sum(e.count * e.least_size(header.order != "") for e in header.elements)
    found = path.stat().st_size
    if found < needed:
        promised = ", ".join(f"{e.count} x {e.name}" for e in header.elements)
        raise DevsegError(
            f"{path}: expected at least {needed} bytes for {promised}, found {found}; "
            "the file is cut off or damaged: export it again"
        )


def restore_attributes(
    mesh: Any, path: str | Path, attributes: Sequence[str] = ATTRIBUTES
) -> list[str]:
    """Gives a mesh loaded from a binary PLY file what the file holds of its faces.

    Args:
        mesh: the pymeshlab mesh that was loaded from the file, unchanged.
        path: the file.
        attributes: their names in the file, charts and seams else.

    Returns:
        The names of the attributes that the mesh has now.
    """
    path = Path(path)
    rows = _face_rows(path) if path.suffix.lower() == ".ply" else None
    # A loader that dropped faces has renumbered them.
    if rows is None or len(rows) != mesh.face_number():
        return []
    names = [name for name in attributes if name in (rows.dtype.names or ())]
    for name in names:
        mesh.add_face_custom_scalar_attribute(rows[name].astype("f8"), name)
    return names


def part_ids(path: Path, faces: int) -> tuple[list[str], np.ndarray] | None:
    """What `finish` has written of the parts of a file.

    Args:
        path: the file.
        faces: the number of faces that the host has made of it.

    Returns:
        The names of the parts as they stand in the comments, and the part of each face; None where
        the file has none.
    """
    import numpy as np

    header, rows, _ = _find_faces(path)
    if header is None or rows is None or len(rows) != faces:
        return None
    lines = path.read_bytes()[: header.size].decode("utf-8", "replace").splitlines()
    found = [match[1] for line in lines if (match := _PART.fullmatch(line))]
    if not found or "part_id" not in (rows.dtype.names or ()):
        return None
    ids = rows["part_id"].astype(np.int64)
    return (found, ids) if ids.min() >= 0 and ids.max() < len(found) else None


def finish(path: Path, comments: Sequence[str], texcoords: np.ndarray | None = None) -> None:
    """Completes a binary file that the host has written.

    Its textures are not named any more, as they do not fit the new coordinates.

    Args:
        path: the file.
        comments: lines for its header.
        texcoords: #F by 6, other texture coordinates, written as the list texcoord_before.
    """
    import numpy as np

    header, rows, offset = _find_faces(path)
    if header is None or rows is None:
        raise DevsegError(f"{path}: expected a binary file with triangles, found another one")
    data = path.read_bytes()
    lines = data[: header.size].decode("utf-8", "replace").splitlines()
    lines = [
        line
        for line in lines
        if not line.startswith("comment TextureFile") and not line.endswith(" texnumber")
    ]
    kept = [name for name in rows.dtype.names or () if name != "texnumber"]
    fields: list[tuple[Any, ...]] = [(name, rows.dtype[name]) for name in kept]
    if texcoords is not None:
        fields += [("texcoord_before length", "u1"), ("texcoord_before", header.order + "f4", (6,))]
        # Properties of faces, the last element of what the host writes, end with the header.
        lines.insert(len(lines) - 1, "property list uchar float texcoord_before")
    lines[2:2] = [f"comment {one_line(comment)}" for comment in comments]
    new = np.empty(len(rows), dtype=fields)
    for name in kept:
        new[name] = rows[name]
    if texcoords is not None:
        new["texcoord_before length"] = 6
        new["texcoord_before"] = texcoords
    text = "\n".join(lines) + "\n"
    rest = data[offset + rows.nbytes :]
    path.write_bytes(text.encode() + data[header.size : offset] + new.tobytes() + rest)


def _face_rows(path: Path) -> np.ndarray | None:
    """The face element as records; None where its rows are not all of one length."""
    return _find_faces(path)[1]


def _find_faces(path: Path) -> tuple[_Header | None, np.ndarray | None, int]:
    """The header, the face element as records, and where it begins."""
    header = _read_header(path)
    if header is None or not header.order:
        return header, None, 0
    data = path.read_bytes()
    offset = header.size
    for element in header.elements:
        if element.name == "face":
            return header, _fixed_rows(element, header.order, data, offset), offset
        if any(p.length_type for p in element.properties):
            break
        offset += element.count * element.least_size(binary=True)
    return header, None, offset


def _fixed_rows(element: _Element, order: str, data: bytes, offset: int) -> np.ndarray | None:
    """Rows whose lists are as long as those of the first row."""
    import numpy as np

    fields: list[tuple[Any, ...]] = []
    lengths: dict[str, int] = {}
    position = offset
    for p in element.properties:
        if p.length_type:
            length_type = np.dtype(order + p.length_type)
            if position + length_type.itemsize > len(data):
                return None
            length = int(np.frombuffer(data, length_type, 1, position)[0])
            lengths[p.name + " length"] = length
            fields.append((p.name + " length", length_type))
            fields.append((p.name, order + p.type, (length,)))
        else:
            fields.append((p.name, order + p.type))
        position = offset + np.dtype(fields).itemsize
    row = np.dtype(fields)
    if offset + element.count * row.itemsize > len(data):
        return None
    rows = np.frombuffer(data, row, element.count, offset)
    same = all(np.all(rows[name] == length) for name, length in lengths.items())
    return rows if same else None
