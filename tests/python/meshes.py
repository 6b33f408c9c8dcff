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


def sheet(mask: list[str]) -> Mesh:
    """Unit squares in the plane where the mask has a '#'."""
    cells = [(x, y) for y, row in enumerate(mask) for x, cell in enumerate(row) if cell == "#"]
    quads = [[(x, y, 0), (x + 1, y, 0), (x + 1, y + 1, 0), (x, y + 1, 0)] for x, y in cells]
    return _of_quads(quads)


def slab(mask: list[str], thickness: float) -> Mesh:
    """The same as a plate, closed all around; holes go through it."""
    cells = {(x, y) for y, row in enumerate(mask) for x, cell in enumerate(row) if cell == "#"}
    quads = []
    for x, y in sorted(cells):
        ring = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        quads.append([(*p, thickness) for p in ring])
        quads.append([(*p, 0) for p in reversed(ring)])
        sides = [(x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y)]
        for i, beside in enumerate(sides):
            a, b = ring[i], ring[(i + 1) % 4]
            if beside not in cells:
                quads.append([(*a, 0), (*b, 0), (*b, thickness), (*a, thickness)])
    return _of_quads(quads)


def _of_quads(quads: list[list[tuple[float, float, float]]]) -> Mesh:
    points = sorted({tuple(map(float, p)) for quad in quads for p in quad})
    number = {p: i for i, p in enumerate(points)}
    corners = [[number[tuple(map(float, p))] for p in quad] for quad in quads]
    faces = [triangle for a, b, c, d in corners for triangle in ([a, b, c], [a, c, d])]
    return np.array(points), np.array(faces)


def washer(inner: float, outer: float, height: float, around: int = 48) -> Mesh:
    """A ring of rectangular profile about the y axis, closed."""
    profile = [(inner, 0.0), (outer, 0.0), (outer, height), (inner, height)]
    angles = 2 * np.pi * np.arange(around) / around
    points = [(r * np.cos(a), y, -r * np.sin(a)) for a in angles for r, y in profile]
    faces = []
    for i in range(around):
        for k in range(4):
            a, b = 4 * i + k, 4 * i + (k + 1) % 4
            c, d = 4 * ((i + 1) % around) + (k + 1) % 4, 4 * ((i + 1) % around) + k
            faces += [[a, c, b], [a, d, c]]
    return np.array(points), np.array(faces)
