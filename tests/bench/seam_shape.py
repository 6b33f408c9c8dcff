"""How smooth seams are, and how acute the corners where they meet. Lengths over the diagonal."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

SPACING = 0.004  # of the points on a line while it is smoothed
ROUNDS = 12  # of smoothing: details of about 1 % of the diagonal go
ARM = 0.025  # from a corner to where its angle is measured
ACUTE = 35.0  # degrees


def seam_lines(edges: np.ndarray) -> list[list[int]]:
    """The seams from one end or junction to the next, as vertices; closed ones without any end."""
    beside: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for k, (a, b) in enumerate(edges.tolist()):
        beside[a].append((k, b))
        beside[b].append((k, a))
    is_used = [False] * len(edges)

    def follow(k: int, start: int) -> list[int]:
        line = [start]
        while True:
            is_used[k] = True
            line.append(next(b for e, b in beside[line[-1]] if e == k))
            onward = [e for e, _ in beside[line[-1]] if not is_used[e]]
            if len(beside[line[-1]]) != 2 or not onward:
                return line
            k = onward[0]

    ends = [v for v in beside if len(beside[v]) != 2]
    lines = []
    for v in ends + list(beside):
        for k, _ in beside[v]:
            if not is_used[k]:
                lines.append(follow(k, v))
    return lines


def waviness(points: np.ndarray, edges: np.ndarray) -> float:
    """Length of the seams over that of smooth lines beside them."""
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    length = smooth_length = 0.0
    for line in seam_lines(edges):
        steps = np.linalg.norm(np.diff(points[line], axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        places = np.linspace(0.0, along[-1], int(np.ceil(along[-1] / (SPACING * diagonal))) + 2)
        curve = np.stack([np.interp(places, along, points[line][:, c]) for c in range(3)], axis=1)
        for _ in range(ROUNDS):
            curve[1:-1] = 0.5 * curve[1:-1] + 0.25 * (curve[2:] + curve[:-2])
        length += along[-1]
        smooth_length += np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
    return length / smooth_length


def acute_corners(points: np.ndarray, edges: np.ndarray) -> int:
    """Pairs of seams that leave one junction nearly side by side."""
    reach = ARM * np.linalg.norm(np.ptp(points, axis=0))
    arms: dict[int, list[np.ndarray]] = defaultdict(list)
    for line in seam_lines(edges):
        for path in (line, line[::-1]):
            steps = np.linalg.norm(np.diff(points[path], axis=0), axis=1)
            along = np.concatenate([[0.0], np.cumsum(steps)])
            end = [np.interp(reach, along, points[path][:, c]) for c in range(3)]
            arm = np.array(end) - points[path[0]]
            arms[path[0]].append(arm / max(float(np.linalg.norm(arm)), 1e-300))
    count = 0
    for directions in arms.values():
        if len(directions) < 3:
            continue
        cosines = np.array(directions) @ np.array(directions).T
        upper = cosines[np.triu_indices(len(directions), 1)]
        count += int((upper > np.cos(np.radians(ACUTE))).sum())
    return count
