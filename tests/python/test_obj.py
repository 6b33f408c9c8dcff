"""Faces of OBJ files that name vertices which are not there."""

from __future__ import annotations

from pathlib import Path

import pytest

from devseg.load import load_mesh
from devseg.obj import faces_without_vertices

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (TRIANGLE + "f 1 2 3\n", (0, 0)),
        (TRIANGLE + "f 1/1/1 2//2 3\nf -3 -2 -1\n", (0, 0)),
        ("f 1 2 3\n" + TRIANGLE, (0, 0)),
        (TRIANGLE + "f 1 2 3\nf 1 2 99\nf 0 1 2\n", (2, 5)),
        (TRIANGLE + "f -4 -2 -1\r\n", (1, 4)),
        ("", (0, 0)),
    ],
)
def test_faces_are_counted(text: str, expected: tuple[int, int], tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(text)
    assert faces_without_vertices(path) == expected


def test_the_loader_tells(tmp_path: Path, pymeshlab: object) -> None:
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE + "f 1 2 3\nf 1 2 99\n")
    _, warnings = load_mesh(path)
    assert warnings == [
        "1 faces name vertices that the file does not have and were left out (the first in line 5)"
    ]
