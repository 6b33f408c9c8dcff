"""The two things about PLY files that the host does not do.

It believes a header that promises more than the file holds, and fills the memory; and it writes
custom face attributes, but does not read them back.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg.errors import DevsegError

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


def restore_attributes(mesh: Any, path: str | Path) -> list[str]:
    """Gives a mesh loaded from a binary PLY file the charts and seams that the file holds.

    Args:
        mesh: the pymeshlab mesh that was loaded from the file, unchanged.
        path: the file.

    Returns:
        The names of the attributes that the mesh has now.
    """
    path = Path(path)
    rows = _face_rows(path) if path.suffix.lower() == ".ply" else None
    # A loader that dropped faces has renumbered them.
    if rows is None or len(rows) != mesh.face_number():
        return []
    names = [name for name in ATTRIBUTES if name in (rows.dtype.names or ())]
    for name in names:
        mesh.add_face_custom_scalar_attribute(rows[name].astype("f8"), name)
    return names


def _face_rows(path: Path) -> np.ndarray | None:
    """The face element as records; None where its rows are not all of one length."""
    header = _read_header(path)
    if header is None or not header.order:
        return None
    data = path.read_bytes()
    offset = header.size
    for element in header.elements:
        if element.name == "face":
            return _fixed_rows(element, header.order, data, offset)
        if any(p.length_type for p in element.properties):
            return None
        offset += element.count * element.least_size(binary=True)
    return None


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
