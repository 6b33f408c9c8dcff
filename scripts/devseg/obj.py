"""What the host passes over in OBJ files without a word, or crashes on."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from devseg.errors import DevsegError

# The lists of the file, and what a person calls an element; in the order of v/vt/vn.
_LISTS = (b"v", b"vt", b"vn")
_NAMES = ("vertex", "texture coordinate", "normal")


@dataclass(frozen=True)
class _Bad:
    """The first face that names what the file does not have."""

    line: int
    name: str
    index: int
    count: int


def check_indices(path: Path) -> None:
    """Refuses a file whose faces name vertices, texture coordinates or normals it does not have.

    The host leaves such faces out, or reads beyond its arrays. A list that is missing altogether
    is no fault: the host passes over its indices.

    Raises:
        DevsegError: with the line of the first such face, numbered from 1.
    """
    data = path.read_bytes()
    bad = None if _is_in_order(data) else _first_bad(data)
    if bad is None:
        return
    has = "1 is the first one" if bad.index == 0 else f"the file has {bad.count}"
    raise DevsegError(
        f"{path}: face in line {bad.line} names {bad.name} {bad.index}, {has}; export it again"
    )


def _is_in_order(data: bytes) -> bool:
    """Whether all faces name elements by numbers from 1 that the file has; nearly all files do."""
    if b"\\\n" in data or b"\\\r" in data:
        return False
    counts = [len(re.findall(rb"^[ \t]*%b[ \t]" % kind, data, re.MULTILINE)) for kind in _LISTS]
    corners = set(b" ".join(re.findall(rb"^[ \t]*f[ \t](.*)$", data, re.MULTILINE)).split())
    for k, named in enumerate(zip_longest(*(corner.split(b"/") for corner in corners))):
        texts = set(named) - {None, b""}
        if k >= len(counts) or not all(map(bytes.isdigit, texts)):
            return False
        indices = set(map(int, texts))
        used = counts[k] > 0 or k == 0
        if used and (min(indices, default=1) < 1 or max(indices, default=1) > counts[k]):
            return False
    return True


def _first_bad(data: bytes) -> _Bad | None:
    counts = [0, 0, 0]
    # Vertices may come after the faces; negative indices count back from where they stand.
    faces: list[tuple[int, list[int], list[bytes]]] = []  # line, what is above it, corners
    for number, words in _lines(data):
        if words[0] in _LISTS:
            counts[_LISTS.index(words[0])] += 1
        elif words[0] == b"f":
            faces.append((number, counts.copy(), words[1:]))
    for number, above, corners in faces:
        for corner in corners:
            for k, index in enumerate(_indices(corner)):
                if index is None or counts[k] == 0 < k:
                    continue
                if index == 0 or not -above[k] <= index <= counts[k]:
                    return _Bad(number, _NAMES[k], index, counts[k])
    return None


def _lines(data: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Words of the lines that are not empty; a backslash at its end goes on with the next line."""
    held = b""
    for number, line in enumerate(data.splitlines(), start=1):
        if line.endswith(b"\\"):
            held += line[:-1] + b" "
            continue
        if words := (held + line).split():
            yield number, words
        held = b""


def _indices(corner: bytes) -> list[int | None]:
    """The indices of v/vt/vn; None for one that is left out or is no number."""
    texts = corner.split(b"/")[:3]
    return [int(text) if text.lstrip(b"-").isdigit() else None for text in texts]
