"""A z-buffer for triangles in numpy: which triangle does every pixel show?

Scan conversion in two expansions, triangles into rows and rows into pixels, so that the work is
proportional to the pixels covered, for a million small triangles as for twelve huge ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# Pixels that are worked on at once: bounds the memory, whatever the mesh.
_CHUNK = 1 << 21


@dataclass(frozen=True)
class Visible:
    """What the pixels of an image show.

    Attributes:
        triangle: height by width, index of the triangle in front, -1 for background.
        rows: of the covered pixels, #P.
        columns: of the covered pixels, #P.
        shown: their triangles, #P.
        barycentric: of the pixel centres in their triangles, #P by 3, in screen space.
    """

    triangle: np.ndarray
    rows: np.ndarray
    columns: np.ndarray
    shown: np.ndarray
    barycentric: np.ndarray


def _repeat_ranges(first: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Owner and value of every element of the ranges [first, first + count)."""
    owner = np.repeat(np.arange(len(count)), count)
    before = np.cumsum(count) - count
    return owner, np.arange(len(owner)) - before[owner] + first[owner]


def rasterize(points: np.ndarray, depth: np.ndarray, width: int, height: int) -> Visible:
    """Renders triangles into a z-buffer; a pixel belongs to the triangle at its centre.

    Args:
        points: #T by 3 by 2, corners in pixels, x to the right and y down.
        depth: #T by 3, smaller is nearer.
        width: of the image.
        height: of the image.
    """
    # Sorted from top to bottom, an edge has the same ends in both of its triangles: the same
    # crossings, no gaps.
    order = np.argsort(points[:, :, 1], axis=1, kind="stable")
    p = np.take_along_axis(points, order[:, :, None], axis=1)
    plane = _plane(points, depth)
    nearest, farthest = depth.min(axis=1), depth.max(axis=1)
    top = np.clip(np.ceil(p[:, 0, 1] - 0.5), 0, height).astype(np.int64)
    bottom = np.clip(np.ceil(p[:, 2, 1] - 0.5), 0, height).astype(np.int64)
    zbuffer = np.full(width * height, np.inf)
    owner = np.full(width * height, -1, dtype=np.int64)
    for chunk in _chunks(bottom - top, points, width):
        which, row = _repeat_ranges(top[chunk], (bottom - top)[chunk])
        which = chunk[which]
        left, right = _spans(p[which], row + 0.5)
        first = np.clip(np.ceil(left - 0.5), 0, width).astype(np.int64)
        last = np.clip(np.ceil(right - 0.5), 0, width).astype(np.int64)
        span, column = _repeat_ranges(first, np.maximum(last - first, 0))
        which, row = which[span], row[span]
        z = _evaluate(plane, which, column + 0.5, row + 0.5)
        # Slivers have wild planes; between its corners a triangle cannot leave their depths.
        z = np.clip(z, nearest[which], farthest[which])
        pixel = row * width + column
        np.minimum.at(zbuffer, pixel, z)
        front = z == zbuffer[pixel]
        owner[pixel[front]] = which[front]
    covered = np.flatnonzero(owner >= 0)
    rows, columns = np.divmod(covered, width)
    shown = owner[covered]
    barycentric = _barycentric(points, shown, columns + 0.5, rows + 0.5)
    return Visible(owner.reshape(height, width), rows, columns, shown, barycentric)


def _chunks(rows: np.ndarray, points: np.ndarray, width: int) -> list[np.ndarray]:
    """Groups of triangles that together cover at most about _CHUNK pixels."""
    extent = np.clip(np.ptp(points[:, :, 0], axis=1), 1, width)
    total = np.cumsum(rows * (extent + 1))
    alive = np.flatnonzero(rows > 0)
    group = (total[alive] // _CHUNK).astype(np.int64)
    return np.split(alive, np.flatnonzero(np.diff(group)) + 1)


def _spans(p: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the intersection of triangles, corners sorted by y, with horizontal lines."""

    def crossing(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        rise = b[:, 1] - a[:, 1]
        t = (y - a[:, 1]) / np.where(rise > 0, rise, 1.0)
        return a[:, 0] + t * (b[:, 0] - a[:, 0])

    upper = y < p[:, 1, 1]
    long = crossing(p[:, 0], p[:, 2])
    short = crossing(
        np.where(upper[:, None], p[:, 0], p[:, 1]), np.where(upper[:, None], p[:, 1], p[:, 2])
    )
    return np.minimum(long, short), np.maximum(long, short)


def _plane(points: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Linear functions over triangles, #T by 3: value = a x + b y + c."""
    e1, e2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    d1, d2 = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
    area = e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]
    area = np.where(area == 0, 1.0, area)
    a = (d1 * e2[:, 1] - d2 * e1[:, 1]) / area
    b = (d2 * e1[:, 0] - d1 * e2[:, 0]) / area
    return np.stack([a, b, values[:, 0] - a * points[:, 0, 0] - b * points[:, 0, 1]], axis=1)


def _evaluate(plane: np.ndarray, which: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return plane[which, 0] * x + plane[which, 1] * y + plane[which, 2]


def _barycentric(points: np.ndarray, shown: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    out = np.empty((len(shown), 3))
    for k in (0, 1):
        corner = np.zeros(points.shape[:2])
        corner[:, k] = 1.0
        out[:, k] = _evaluate(_plane(points, corner), shown, x, y)
    out[:, 2] = 1.0 - out[:, 0] - out[:, 1]
    return out
