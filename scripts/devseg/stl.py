"""STL files as text: the names of their solids, and all of their triangles.

The host loses the first triangle of every solid but the first one, and says nothing.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

_HEADER, _ROW = 80, 50  # bytes of a binary file: its header, and each triangle
_SOLID = re.compile(rb"^[ \t]*solid\b[ \t]*(.*?)[ \t\r]*$", re.MULTILINE | re.IGNORECASE)
_NUMBER = rb"([-+.\w]+)"
_VERTEX = re.compile(rb"\bvertex\s+%b\s+%b\s+%b" % (_NUMBER, _NUMBER, _NUMBER), re.IGNORECASE)


@dataclass(frozen=True)
class Solid:
    """A solid of the file.

    Attributes:
        name: what follows the word solid.
        triangles: #T by 3 by 3 coordinates; those that repeat a vertex are left out.
    """

    name: str
    triangles: np.ndarray


def is_text(data: bytes) -> bool:
    """Whether these are words, although binary files may begin with the word solid as well."""
    rows = int.from_bytes(data[_HEADER : _HEADER + 4], "little")
    return data[:_HEADER].lstrip().lower().startswith(b"solid") and (
        len(data) != _HEADER + 4 + _ROW * rows
    )


def solids(path: Path) -> list[Solid]:
    """The solids of a text; none of a binary file, nor of a text that cannot be understood."""
    import numpy as np

    data = path.read_bytes()
    if not is_text(data):
        return []
    heads = list(_SOLID.finditer(data))
    ends = [head.start() for head in heads[1:]] + [len(data)]
    found = []
    try:
        for head, end in zip(heads, ends, strict=True):
            rows = _VERTEX.findall(data, head.end(), end)
            corners = np.array(rows, dtype="S40").astype("<f4").reshape(-1, 3, 3)
            a, b, c = np.moveaxis(corners, 1, 0)
            same = (a == b).all(axis=1) | (b == c).all(axis=1) | (c == a).all(axis=1)
            found.append(Solid(head[1].decode("utf-8", "replace"), corners[~same]))
    except ValueError:
        return []
    return found


def rewritten(path: Path, folder: Path) -> Path:
    """A binary file with all triangles, for the host; the file itself where that reads it all."""
    import numpy as np

    found = solids(path)
    if len(found) < 2:
        return path
    triangles = np.concatenate([solid.triangles for solid in found])
    rows = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")])
    rows["corners"] = triangles
    target = folder / path.name
    target.write_bytes(bytes(_HEADER) + len(rows).to_bytes(4, "little") + rows.tobytes())
    return target
