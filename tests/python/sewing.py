"""A checker of assembly orders: it sews step by step, knowing only which pieces each seam joins."""

from __future__ import annotations

from typing import Any

import numpy as np


def solids(points: np.ndarray, faces: np.ndarray) -> tuple[int, int]:
    """Connected parts of a mesh: those without an open edge, and all.

    Vertices at the same place are one.
    """
    _, same = np.unique(points, axis=0, return_inverse=True)
    corners = same.reshape(-1)[faces]
    corners = corners[[len(set(face)) == 3 for face in corners.tolist()]]
    part = np.arange(same.max() + 1)
    while True:
        least = part[corners].min(axis=1)
        after = part.copy()
        np.minimum.at(after, corners.reshape(-1), np.repeat(least, 3))
        after = after[after]
        if np.array_equal(after, part):
            break
        part = after
    edges = np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(edges, axis=0, return_counts=True)
    is_open = set(part[edges[uses != 2][:, 0]].tolist())
    every = set(part[corners].reshape(-1).tolist())
    return len(every - is_open), len(every)


class Sewing:
    """What hangs together so far."""

    def __init__(self, names: list[str]) -> None:
        self.part = {name: {name} for name in names}

    def join(self, a: str, b: str) -> None:
        joined = self.part[a] | self.part[b]
        for name in joined:
            self.part[name] = joined

    def together(self, names: set[str]) -> bool:
        return names <= self.part[next(iter(names))]


def check_order(results: dict[str, Any], order: dict[str, Any]) -> list[set[str]]:
    """Sews what each step says, and returns the parts that are closed, in their order.

    Every step works on one part; a part that was closed is done; and where anything is closed, so
    it is by the last step.
    """
    names = list(order["sections"])
    sides = [
        (names[int(a)], names[int(b)])
        for a, b in zip(results["seam_first_piece"], results["seam_second_piece"], strict=True)
    ]
    whole = Sewing(names)  # with all seams
    for a, b in sides:
        whole.join(a, b)
    open_seams = {opening["seam"] for opening in order["openings"]}
    sewn = Sewing(names)
    done: set[int] = set()
    closed: list[set[str]] = []
    for step in order["steps"]:
        assert step["seams"], "a step does nothing"
        touched = {name for seam in step["seams"] for name in sides[seam - 1]}
        assert not any(touched & part for part in closed), "work on a part that is closed"
        is_closing = step["kind"] == "close"
        for seam in step["seams"]:
            assert seam not in done or (is_closing and seam in open_seams), "sewn twice"
            done.add(seam)
            sewn.join(*sides[seam - 1])
        assert sewn.together(touched), "parts that share no seam are joined"
        if is_closing:
            part = whole.part[next(iter(touched))]
            ends = {seam for seam, (a, _) in enumerate(sides, 1) if a in part}
            assert ends <= done, "closed before all of its seams are sewn"
            closed.append(part)
    assert done == set(range(1, len(sides) + 1)), "seams are left"
    assert not closed or order["steps"][-1]["kind"] == "close", "the last step closes nothing"
    return closed
