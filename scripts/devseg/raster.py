"""A z-buffer for triangles in numpy: which triangle does every pixel show?

Scan conversion in two expansions, triangles into rows and rows into pixels, so that the work is
proportional to the pixels covered, for a million small triangles as for twelve huge ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

# Pixels that are worked on at once: bounds the memory, whatever the mesh.
_CHUNK = 1 << 21
# Pixels of all triangles together, seen or hidden, that are worth drawing: where hundreds of sheets
# lie behind each other, pixels are drawn as blocks, so that a picture takes no longer than others.
_MOST_PIXELS = 2e6
# Pixels along a tile, whose farthest depth tells what is hidden: as large as small triangles.
_TILE = 8


@dataclass(frozen=True)
class Visible:
    """What the pixels of an image show.

    Attributes:
        triangle: height by width, index of the triangle in front, -1 for background.
        pixels: that are covered, #P, counted along the rows.
        shown: their triangles, #P.
        weights: of the triangles, see _weights.
    """

    triangle: np.ndarray
    pixels: np.ndarray
    shown: np.ndarray
    weights: np.ndarray

    def barycentric(self, chosen: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Of the centres of chosen ones of the #P pixels in their triangles, by 3, on screen."""
        rows, columns = np.divmod(self.pixels[chosen], self.triangle.shape[1])
        return _barycentric(self.weights, self.shown[chosen], columns + 0.5, rows + 0.5)


def _ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """The values of the ranges [first, first + count), one after the other."""
    before = np.cumsum(count) - count
    values = np.repeat(first - before, count)
    values += np.arange(len(values))
    return values


def rasterize(points: np.ndarray, depth: np.ndarray | None, width: int, height: int) -> Visible:
    """Renders triangles into a z-buffer; a pixel belongs to the triangle at its centre.

    Args:
        points: #T by 3 by 2, corners in pixels, x to the right and y down.
        depth: #T by 3, smaller is nearer; None: later triangles lie on earlier ones.
        width: of the image.
        height: of the image.
    """
    x0, x1, x2, y0, y1, y2 = (points[:, k, c] for c in (0, 1) for k in range(3))
    area = 0.5 * float(np.abs((x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)).sum())
    coarseness = math.ceil(math.sqrt(area / _MOST_PIXELS)) or 1
    weights = _weights(points)
    if coarseness > 1:
        blocks = points / coarseness
        owner = _owners(
            blocks, _weights(blocks), depth, -(-width // coarseness), -(-height // coarseness)
        )
        owner = owner.repeat(coarseness, axis=0).repeat(coarseness, axis=1)[:height, :width]
    else:
        owner = _owners(points, weights, depth, width, height)
    covered = np.flatnonzero(owner >= 0)
    return Visible(owner, covered, owner.ravel()[covered], weights)


def _owners(
    points: np.ndarray, weights: np.ndarray, depth: np.ndarray | None, width: int, height: int
) -> np.ndarray:
    """The triangle in front at the centre of each pixel, height by width, -1 for none."""
    hidden = _HiddenSurfaces(weights, depth, width, height)
    edges = _Edges.of(points)
    x0, x1, x2 = points[:, :, 0].T
    sides = [end(end(x0, x1), x2) for end in (np.minimum, np.maximum)]
    box = _Boxes(
        *(_pixels(side, width) for side in sides),
        *(_pixels(side, height) for side in (edges.top, edges.bottom)),
    )
    rows = box.bottom - box.top
    for group in hidden.groups(box):
        for chunk in _chunks(group, rows, box):
            which, row = np.repeat(chunk, rows[chunk]), _ranges(box.top[chunk], rows[chunk])
            y = row + 0.5
            left, right = edges.span(which, y)
            first = _pixels(left, width)
            count = np.maximum(_pixels(right, width) - first, 0)
            hidden.draw(which, y, count, _ranges(first, count), row * width)
    return hidden.owner.reshape(height, width)


def _pixels(side: np.ndarray, size: int) -> np.ndarray:
    """The first pixel whose centre is not before it, in rows or columns of `size`."""
    return np.clip(np.ceil(side - 0.5), 0, size).astype(np.int64)


@dataclass(frozen=True)
class _Boxes:
    """Pixels that triangles may cover: columns left … right - 1, rows top … bottom - 1."""

    left: np.ndarray
    right: np.ndarray
    top: np.ndarray
    bottom: np.ndarray

    def covered(self) -> np.ndarray:
        """The triangles that may cover any."""
        return np.flatnonzero((self.left < self.right) & (self.top < self.bottom))


class _HiddenSurfaces:
    """Which triangle is in front at each pixel, -1 for none.

    Reference:
        N. Greene, M. Kass, G. Miller: Hierarchical Z-Buffer Visibility. SIGGRAPH 1993.
    """

    def __init__(
        self, weights: np.ndarray, depth: np.ndarray | None, width: int, height: int
    ) -> None:
        self.size = height, width
        self.owner = np.full(width * height, -1, dtype=np.int64)
        self.plane = None
        if depth is not None:
            # The depth of a triangle is a x + b y + c.
            parts = weights[0] * (depth[:, 0] - depth[:, 2]) + weights[1] * (
                depth[:, 1] - depth[:, 2]
            )
            parts[2] += depth[:, 2]
            self.plane = parts
            self.nearest = np.minimum(np.minimum(depth[:, 0], depth[:, 1]), depth[:, 2])
            self.farthest = np.maximum(np.maximum(depth[:, 0], depth[:, 1]), depth[:, 2])
            self.zbuffer = np.full(width * height, np.inf)

    def groups(self, box: _Boxes) -> Iterator[np.ndarray]:
        """All triangles to be drawn: the near half, then what it does not hide of the others."""
        alive = box.covered()
        if self.plane is None or not len(alive):
            yield alive
            return
        near = self.nearest[alive] <= np.median(self.nearest[alive])
        yield alive[near]
        yield self._not_hidden(alive[~near], box)

    def _not_hidden(self, which: np.ndarray, box: _Boxes) -> np.ndarray:
        """Those of the triangles that are not behind all that tiles of pixels show."""
        farthest = self.zbuffer.reshape(self.size)
        for axis in (0, 1):
            farthest = np.maximum.reduceat(
                farthest, np.arange(0, self.size[axis], _TILE), axis=axis
            )
        low, high = box.top[which] // _TILE, (box.bottom[which] - 1) // _TILE
        left, right = box.left[which] // _TILE, (box.right[which] - 1) // _TILE
        shown = np.maximum(
            np.maximum(farthest[low, left], farthest[low, right]),
            np.maximum(farthest[high, left], farthest[high, right]),
        )
        large = (high - low > 1) | (right - left > 1)  # over more tiles than their corners are in
        return which[large | (self.nearest[which] <= shown)]

    def draw(
        self,
        which: np.ndarray,
        y: np.ndarray,
        count: np.ndarray,
        column: np.ndarray,
        begin: np.ndarray,
    ) -> None:
        """Draws spans of rows.

        Args:
            which: triangle of each span.
            y: height of each span.
            count: pixels of each span.
            column: of each pixel, span after span.
            begin: first pixel of the row of each span.
        """
        pixel = np.repeat(begin, count) + column
        owner = np.repeat(which, count)
        if self.plane is None:
            self.owner[pixel] = owner
            return
        z = np.repeat(self.plane[0][which], count)
        z *= column + 0.5
        z += np.repeat(self.plane[1][which] * y + self.plane[2][which], count)
        # Slivers have wild planes; between its corners a triangle cannot leave their depths.
        ends = (np.repeat(end[which], count) for end in (self.nearest, self.farthest))
        z = np.clip(z, *ends)
        np.minimum.at(self.zbuffer, pixel, z)
        front = z == self.zbuffer[pixel]
        self.owner[pixel[front]] = owner[front]


def _chunks(group: np.ndarray, rows: np.ndarray, box: _Boxes) -> list[np.ndarray]:
    """Parts of a group of triangles that cover at most about _CHUNK pixels."""
    extent = (box.right - box.left)[group]
    part = np.cumsum(rows[group] * (extent + 1)) // _CHUNK
    return np.split(group, np.flatnonzero(np.diff(part)) + 1)


@dataclass(frozen=True)
class _Edges:
    """The edges of triangles as lines x = x0 + slope (y - y0), each from its upper end."""

    top: np.ndarray  # #T, the least y
    bottom: np.ndarray  # #T
    middle: np.ndarray  # #T, y of the corner between
    # From the upper to the lower corner, and the two others, one below the other: 3 #T.
    x: np.ndarray
    y: np.ndarray
    slope: np.ndarray

    @classmethod
    def of(cls, points: np.ndarray) -> _Edges:
        # Sorted from top to bottom, an edge has the same ends in both of its triangles: the same
        # crossings, no gaps.
        order = np.argsort(points[:, :, 1], axis=1, kind="stable")
        corner = (order + 3 * np.arange(len(points))[:, None]).T
        x, y = points[:, :, 0].ravel()[corner], points[:, :, 1].ravel()[corner]
        upper, lower = [0, 0, 1], [2, 1, 2]
        rise = y[lower] - y[upper]
        slope = (x[lower] - x[upper]) / np.where(rise > 0, rise, 1.0)
        return cls(y[0], y[2], y[1], x[upper].ravel(), y[upper].ravel(), slope.ravel())

    def span(self, which: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Ends of the intersection of triangles with horizontal lines."""
        below = np.where(y < self.middle[which], 1, 2)
        long = self._crossing(which, y)
        short = self._crossing(which + below * len(self.top), y)
        return np.minimum(long, short), np.maximum(long, short)

    def _crossing(self, edge: np.ndarray, y: np.ndarray) -> np.ndarray:
        return self.x[edge] + self.slope[edge] * (y - self.y[edge])


def _weights(points: np.ndarray) -> np.ndarray:
    """The first two barycentric coordinates as functions a x + b y + c: 2 by 3 by #T."""
    (x0, y0), (x1, y1), (x2, y2) = (np.ascontiguousarray(points[:, k].T) for k in range(3))
    area = (x0 - x2) * (y1 - y2) - (x1 - x2) * (y0 - y2)
    inverse = 1.0 / np.where(area == 0, 1.0, area)
    a0, b0 = (y1 - y2) * inverse, (x2 - x1) * inverse
    a1, b1 = (y2 - y0) * inverse, (x0 - x2) * inverse
    return np.array([[a0, b0, -a0 * x2 - b0 * y2], [a1, b1, -a1 * x2 - b1 * y2]])


def _barycentric(
    weights: np.ndarray, shown: np.ndarray, x: np.ndarray, y: np.ndarray
) -> np.ndarray:
    out = np.empty((len(shown), 3), dtype=np.float32)
    for k, (a, b, c) in enumerate(weights):
        # Rounding must not carry slivers out of their corners.
        out[:, k] = np.clip(a[shown] * x + b[shown] * y + c[shown], 0, 1)
    out[:, 2] = np.maximum(1 - out[:, 0] - out[:, 1], 0)
    return out
