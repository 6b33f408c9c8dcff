"""Faces of OBJ files that name what is not there."""

from __future__ import annotations

from pathlib import Path

import pytest

from devseg.errors import DevsegError
from devseg.obj import check_indices

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

IN_ORDER = [
    TRIANGLE + "f 1 2 3\n",
    TRIANGLE + "f 1/1/1 2//2 3\nf -3 -2 -1\n",  # there are no other lists: the host passes over it
    "f 1 2 3\n" + TRIANGLE,
    TRIANGLE + "vt 0 0\nvn 0 0 1\n\tf 1/1/1 2/-1/-1 \\\n3/1/1\n",
    "",
]

WRONG = [
    ("f 1 2 3\nf 1 2 99\nf 0 1 2\n", "face in line 5 names vertex 99, the file has 3"),
    ("f 0 1 2\n", "face in line 4 names vertex 0, 1 is the first one"),
    ("f -4 -2 -1\r\n", "face in line 4 names vertex -4, the file has 3"),
    ("f -3 -2 -1\nv 1 1 1\nf -5 -2 -1\n", "face in line 6 names vertex -5, the file has 4"),
    ("vt 0 0\nf 1/1 2/0 3/1\n", "line 5 names texture coordinate 0, 1 is the first one"),
    ("vt 0 0\nf 1/1 2/7 3/1\n", "line 5 names texture coordinate 7, the file has 1"),
    ("vn 0 0 1\nf 1//1 2//1 3//2\n", "face in line 5 names normal 2, the file has 1"),
]


@pytest.mark.parametrize("text", IN_ORDER)
def test_files_in_order_pass(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(text)
    check_indices(path)


@pytest.mark.parametrize(("text", "reason"), WRONG)
def test_the_first_wrong_index_is_named(text: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_bytes((TRIANGLE + text).encode())
    with pytest.raises(DevsegError, match=reason):
        check_indices(path)
