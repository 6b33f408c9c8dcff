"""Small meshes with known properties, and writing them as files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def write_obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> Path:
    rows = ["v {:.17g} {:.17g} {:.17g}".format(*vertex) for vertex in vertices]
    rows += ["f {} {} {}".format(*(face + 1)) for face in faces]
    path.write_text("\n".join(rows) + "\n")
    return path


def grid(u: int, v: int, wrap_u: bool = False, twist: bool = False) -> tuple[np.ndarray, ...]:
    """Parameters in [0, 1]² and faces of a grid of u by v cells, its ends joined if asked for."""
    columns = u if wrap_u else u + 1
    s, t = np.meshgrid(np.arange(columns) / u, np.arange(v + 1) / v, indexing="ij")
    faces = []
    for i in range(u):
        for j in range(v):
            a, b, c, d = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            corner = [_index(p, u, v, wrap_u, twist) for p in (a, b, c, d)]
            faces += [[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]]
    return s.ravel(), t.ravel(), np.array(faces)


def _index(p: tuple[int, int], u: int, v: int, wrap: bool, twist: bool) -> int:
    i, j = p
    if wrap and i == u:
        i, j = 0, (v - j if twist else j)
    return i * (v + 1) + j


def cylinder(radius: float = 1.0, height: float = 3.0, around: int = 48, along: int = 12) -> Mesh:
    """An open tube about the y axis; exactly developable up to the polygon."""
    s, t, faces = grid(around, along, wrap_u=True)
    a = 2 * np.pi * s
    return np.stack([radius * np.cos(a), height * t, -radius * np.sin(a)], axis=1), faces


def sphere(around: int = 32, along: int = 16) -> Mesh:
    """A unit sphere without its poles' caps."""
    s, t, faces = grid(around, along, wrap_u=True)
    a, b = 2 * np.pi * s, 0.1 + (np.pi - 0.2) * t
    points = [np.sin(b) * np.cos(a), np.cos(b), np.sin(b) * np.sin(a)]
    return np.stack(points, axis=1), faces


def moebius(around: int = 60, across: int = 6) -> Mesh:
    """A one-sided strip."""
    s, t, faces = grid(around, across, wrap_u=True, twist=True)
    a, w = 2 * np.pi * s, 0.6 * (t - 0.5)
    r = 2 + w * np.cos(a / 2)
    return np.stack([r * np.cos(a), w * np.sin(a / 2), r * np.sin(a)], axis=1), faces


def cube() -> Mesh:
    """A unit cube of twelve faces."""
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [[[q[0], q[1], q[2]], [q[0], q[2], q[3]]] for q in quads]
    return vertices, np.array(faces).reshape(-1, 3)


def joined(first: Mesh, second: Mesh, shift: tuple[float, float, float]) -> Mesh:
    """Two components in one mesh."""
    vertices = np.vstack([first[0], second[0] + np.array(shift)])
    return vertices, np.vstack([first[1], second[1] + len(first[0])])


def three_fins() -> Mesh:
    """Three triangles on one edge: no manifold, no orientation."""
    vertices = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0.5], [-1, 0, -0.5]], dtype=float)
    return vertices, np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]])
