"""Flattening charts that come from elsewhere: here the six directions of a rounded box."""

import sys
from pathlib import Path

import numpy as np

import devseg


def rounded_box(size: int = 10) -> tuple[np.ndarray, np.ndarray]:
    """A cube whose grid is pulled halfway onto a ball."""
    count = size + 1
    corner, number = [], {}
    faces = []

    def vertex(p: tuple[int, int, int]) -> int:
        if p not in number:
            number[p] = len(corner)
            corner.append(p)
        return number[p]

    for axis in range(3):
        for side in (0, size):
            for i in range(count - 1):
                for j in range(count - 1):
                    square = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        p = [0, 0, 0]
                        p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, i + di, j + dj
                        square.append(vertex(tuple(p)))
                    a, b, c, d = square if side else square[::-1]
                    faces += [[a, b, c], [a, c, d]]
    points = 2 * np.array(corner) / size - 1
    return points * (1 + 1 / np.linalg.norm(points, axis=1, keepdims=True)) / 2, np.array(faces)


def main(out: Path) -> None:
    """Writes the pattern."""
    vertices, faces = rounded_box()
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axis = np.abs(normals).argmax(axis=1)
    labels = 2 * axis + (np.take_along_axis(normals, axis[:, None], 1)[:, 0] > 0)
    atlas = devseg.unwrap(vertices, faces, charts=labels, flatten="arap")
    for chart, stretch in enumerate(atlas.measures["chart_l2_stretch"]):
        print(f"chart {chart}: {np.sum(atlas.chart_id == chart)} faces, L2 stretch {stretch:.4f}")
    out.mkdir(parents=True, exist_ok=True)
    devseg.pattern(atlas, longest_mm=100).save(out / "box.svg")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
