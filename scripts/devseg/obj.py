"""What the host passes over in OBJ files without a word."""

from __future__ import annotations

from pathlib import Path


def faces_without_vertices(path: Path) -> tuple[int, int]:
    """How many faces name vertices that the file does not have, and the line of the first one.

    Lines are numbered from 1; (0, 0) where all faces are in order. Indices that are no numbers are
    the host's business, which refuses them.
    """
    vertices = 0
    faces: list[
        tuple[int, int, bytes]
    ] = []  # line, vertices above it, text: faces to look at again
    for number, line in enumerate(path.read_bytes().splitlines(), start=1):
        if line.startswith(b"v "):
            vertices += 1
        elif line.startswith(b"f "):
            indices = [_number(word) for word in line.split()[1:]]
            if min(indices, default=1) < 1 or max(indices, default=1) > vertices:
                faces.append((number, vertices, line))
    # Vertices may come after the faces; negative indices count back from where they stand.
    bad = [
        number
        for number, before, line in faces
        if any(not -before <= i <= vertices or i == 0 for i in map(_number, line.split()[1:]))
    ]
    return len(bad), (bad[0] if bad else 0)


def _number(word: bytes) -> int:
    text = word.split(b"/", 1)[0]
    return int(text) if text.lstrip(b"-").isdigit() else 1
