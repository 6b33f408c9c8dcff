"""The picture of a result: the mesh beside its pattern, in the same colours. Needs no OpenGL."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from devseg.raster import Visible, rasterize

if TYPE_CHECKING:
    from collections.abc import Sequence

    from devseg.host import MeshData

# Pixels are rendered this much finer in both directions and averaged.
SUPERSAMPLING = 2
# Share of a panel's side that stays empty on each side.
MARGIN = 0.04
# Half the width of a seam line, in pixels of the finished picture.
LINE = 0.7
INK = np.array([0.13, 0.13, 0.16])
# Three-quarter views: turns about y (0 looks along -z), seen from this much above.
AZIMUTHS = (-35.0, 35.0, -145.0, 145.0)
ELEVATION = 18.0
# Another side than the front must show this much more to be preferred.
FRONT_BONUS = 1.15
# A vertex whose faces bend further than this from its normal lies on a crease.
SMOOTH_COSINE = math.cos(math.radians(40.0))
LIGHT = np.array([-0.45, 0.65, 0.61])


@dataclass(frozen=True)
class _Panel:
    """Triangles placed in a square image, ready to be shaded."""

    points: np.ndarray
    visible: Visible


def render_pair(data: MeshData, size: int = 800) -> Image.Image:
    """The shaded mesh on the left, its flattened charts with their numbers on the right.

    Args:
        data: a mesh with charts and texture coordinates.
        size: height of the picture in pixels; it is twice as wide.
    """
    canvas = np.ones((size, 2 * size, 3))
    canvas[:, :size] = _reduce(_mesh_panel(data, size * SUPERSAMPLING))
    pattern, labels = _pattern_panel(data, size * SUPERSAMPLING)
    canvas[:, size:] = _reduce(pattern)
    image = Image.fromarray(np.round(canvas * 255).astype(np.uint8))
    _draw_numbers(image, labels, (size, 0))
    return image


def render_meshes(data: Sequence[MeshData], titles: Sequence[str], size: int = 600) -> Image.Image:
    """Shaded meshes side by side, each with its title below; all from the same side.

    Args:
        data: the same mesh with different charts.
        titles: one for each.
        size: width of each mesh in pixels.
    """
    foot = size // 10
    panels = [_reduce(_mesh_panel(one, size * SUPERSAMPLING)) for one in data]
    canvas = np.ones((size + foot, size * len(panels), 3))
    canvas[:size] = np.concatenate(panels, axis=1)
    image = Image.fromarray(np.round(canvas * 255).astype(np.uint8))
    draw = ImageDraw.Draw(image)
    font = ImageFont.load_default(size=foot // 2)
    for i, title in enumerate(titles):
        draw.text(((i + 0.5) * size, size + foot // 3), title, fill="black", font=font, anchor="mm")
    return image


def view_rotation(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Rotation to the three-quarter view that shows the most surface; rows are right, up, back."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    best, chosen = -1.0, np.eye(3)
    for azimuth in AZIMUTHS:
        a, e = math.radians(azimuth), math.radians(ELEVATION)
        back = np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])
        right = np.array([math.cos(a), 0.0, -math.sin(a)])
        shown = float(np.abs(normals @ back).sum()) * (FRONT_BONUS if abs(azimuth) < 90 else 1)
        if shown > best * (1 + 1e-9):
            best, chosen = shown, np.stack([right, np.cross(back, right), back])
    return chosen


def _reduce(image: np.ndarray) -> np.ndarray:
    """Averages the finer pixels."""
    s = SUPERSAMPLING
    parts = [image[row::s, column::s] for row in range(s) for column in range(s)]
    return np.add.reduce(parts) / len(parts)


def _fit(points: np.ndarray, size: int) -> np.ndarray:
    """Points (any shape, last axis x y with y up), centred in a square image with y down."""
    flat = points.reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    extent = float((high - low).max()) or 1.0
    scaled = (points - (low + high) / 2) * (size * (1 - 2 * MARGIN) / extent)
    return scaled * np.array([1.0, -1.0]) + size / 2


def _mesh_panel(data: MeshData, size: int) -> np.ndarray:
    rotation = view_rotation(data.vertices, data.faces)
    used = np.unique(data.faces)
    seen = (data.vertices - data.vertices[used].mean(axis=0)) @ rotation.T
    corners = seen[data.faces]
    points = _fit(corners[:, :, :2], size)
    visible = rasterize(points, -corners[:, :, 2], size, size)
    panel = _Panel(points, visible)
    normals = _pixel_normals(seen, data.faces, visible)
    color = _shade(data.colors[visible.shown], normals)
    line = _edge_mask(panel, data.seams) | _change_mask(data.charts, visible)
    return _compose(visible, color, line, size)


def _pattern_panel(data: MeshData, size: int) -> tuple[np.ndarray, list[_Label]]:
    points = _fit(data.texcoords, size)
    visible = rasterize(points, np.zeros(points.shape[:2]), size, size)
    outline = data.seams | _mesh_border(data.faces)
    line = _edge_mask(_Panel(points, visible), outline) | _change_mask(data.charts, visible)
    image = _compose(visible, data.colors[visible.shown], line, size)
    charts = np.where(visible.triangle >= 0, data.charts[visible.triangle], -1)
    return image, _labels(charts)


def _compose(visible: Visible, color: np.ndarray, line: np.ndarray, size: int) -> np.ndarray:
    image = np.ones((size, size, 3))
    image[visible.rows, visible.columns] = np.where(line[:, None], INK, color)
    return image


def _pixel_normals(seen: np.ndarray, faces: np.ndarray, visible: Visible) -> np.ndarray:
    """Interpolated normals of the visible pixels, #P by 3, turned to the viewer."""
    corners = seen[faces]
    weighted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    of_face = _normalized(weighted)
    of_vertex = np.stack(
        [np.bincount(faces.ravel(), np.repeat(weighted[:, k], 3), len(seen)) for k in range(3)],
        axis=1,
    )
    of_vertex = _normalized(of_vertex)
    # A vertex on a crease has no normal that serves both of its sides.
    straightness = np.ones(len(seen))
    for k in range(3):
        cosine = (of_vertex[faces[:, k]] * of_face).sum(axis=1)
        np.minimum.at(straightness, faces[:, k], cosine)
    creased = straightness < SMOOTH_COSINE
    shown = visible.shown
    weights = np.clip(visible.barycentric, 0, 1)
    flat = of_face[shown]
    total = np.zeros((len(shown), 3))
    for k in range(3):
        corner = faces[shown, k]
        normal = np.where(creased[corner, None], flat, of_vertex[corner])
        total += weights[:, k, None] * normal
    total = _normalized(total)
    return total * np.where(flat[:, 2] < 0, -1.0, 1.0)[:, None]


def _normalized(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def _shade(color: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """A key light from the upper left, light from the sky, and a soft highlight."""
    key = np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    sky = 0.5 + 0.5 * normals[:, 1]
    half = LIGHT / np.linalg.norm(LIGHT) + np.array([0.0, 0.0, 1.0])
    gloss = np.clip(normals @ (half / np.linalg.norm(half)), 0, 1) ** 40
    brightness = 0.5 + 0.16 * sky + 0.42 * key
    return np.clip(color * brightness[:, None] + 0.10 * gloss[:, None], 0, 1)


def _edge_mask(panel: _Panel, edges: np.ndarray) -> np.ndarray:
    """Visible pixels near an edge of their own triangle that is marked in `edges` (#T by 3)."""
    visible = panel.visible
    mask = np.zeros(len(visible.shown), dtype=bool)
    near = np.flatnonzero(edges[visible.shown].any(axis=1))
    shown = visible.shown[near]
    p = panel.points
    e1, e2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    area = np.abs(e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
    for k in range(3):
        length = np.linalg.norm(p[:, (k + 1) % 3] - p[:, k], axis=1)
        height = area / np.where(length > 0, length, 1)
        # The corner opposite of the edge from k to k+1 is k+2.
        distance = visible.barycentric[near, (k + 2) % 3] * height[shown]
        mask[near] |= edges[shown, k] & (distance < LINE * SUPERSAMPLING)
    return mask


def _change_mask(charts: np.ndarray, visible: Visible) -> np.ndarray:
    """Visible pixels beside one of another chart or of the background.

    Where triangles are smaller than a pixel, the distance to their own edges misses lines.
    """
    image = np.where(visible.triangle >= 0, charts[visible.triangle], -1)
    changes = np.zeros(image.shape, dtype=bool)
    for neighbor in _neighbors(image, SUPERSAMPLING):
        changes |= neighbor != image
    return changes[visible.rows, visible.columns]


def _neighbors(image: np.ndarray, distance: int) -> list[np.ndarray]:
    """The image moved up, down, left and right, with background moving in."""
    d = distance
    padded = np.pad(image, d, constant_values=-1)
    height, width = image.shape
    starts = ((0, d), (2 * d, d), (d, 0), (d, 2 * d))
    return [padded[row : row + height, column : column + width] for row, column in starts]


def _mesh_border(faces: np.ndarray) -> np.ndarray:
    """Whether the edges of the faces have no second face, #F by 3."""
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    ends = np.sort(ends, axis=1)
    key = ends[:, 0] * (int(faces.max()) + 1) + ends[:, 1]
    _, index, count = np.unique(key, return_inverse=True, return_counts=True)
    return (count[index.ravel()] == 1).reshape(-1, 3)


@dataclass(frozen=True)
class _Label:
    """A piece's number and the largest disk of the piece found for it, in finished pixels."""

    text: str
    x: float
    y: float
    radius: float


def _labels(charts: np.ndarray) -> list[_Label]:
    """The innermost pixel of every chart, by peeling layers off the charts' pixels."""
    step = 2 * SUPERSAMPLING
    image = charts[step // 2 :: step, step // 2 :: step]
    inside = image >= 0
    layers = np.zeros(image.shape, dtype=np.int64)
    while inside.any():
        layers += inside
        peeled = np.where(inside, image, -1)
        inside = inside & np.logical_and.reduce([n == image for n in _neighbors(peeled, 1)])
    order = np.argsort(image.ravel(), kind="stable")
    starts = np.flatnonzero(np.diff(image.ravel()[order], prepend=-2))
    labels = []
    for pixels in np.split(order, starts[1:]):
        chart = image.flat[pixels[0]]
        if chart >= 0:
            depth = layers.flat[pixels]
            place = np.stack(np.divmod(pixels, image.shape[1]), axis=1) + 0.5
            # Of the pixels that lie about as deep, the one nearest to the middle.
            off_center = np.linalg.norm(place - place.mean(axis=0), axis=1)
            chosen = np.argmin(np.where(depth >= 0.8 * depth.max(), off_center, np.inf))
            scale = step // SUPERSAMPLING
            y, x = place[chosen] * scale
            labels.append(_Label(str(chart + 1), x, y, float(depth[chosen]) * scale))
    return labels


def _draw_numbers(image: Image.Image, labels: list[_Label], origin: tuple[int, int]) -> None:
    draw = ImageDraw.Draw(image)
    for label in labels:
        size = min(1.1 * label.radius, 0.035 * image.height)
        # Smaller than this nobody can read it.
        if size >= 7:
            font = ImageFont.load_default(size=size)
            position = (origin[0] + label.x, origin[1] + label.y)
            fill = tuple(int(255 * part) for part in INK)
            draw.text(position, label.text, fill=fill, font=font, anchor="mm")
