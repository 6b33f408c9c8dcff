"""The picture of a result: the mesh beside its pattern, in the same colours. Needs no OpenGL."""

from __future__ import annotations

import functools
import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from devseg.raster import Visible, rasterize

if TYPE_CHECKING:
    from collections.abc import Sequence

    from devseg.host import MeshData

# Share of a panel's side that stays empty on each side.
MARGIN = 0.04
# Half the width of a seam line, in pixels.
LINE = 0.7
# What a line of one pixel keeps of its darkness where it is drawn softly: it looks 1.5 wide.
SOFT_LINE = 1.6
INK = np.array([0.13, 0.13, 0.16], dtype=np.float32)
# Three-quarter views: turns about y (0 looks along -z), seen from this much above.
AZIMUTHS = (-35.0, 35.0, -145.0, 145.0)
ELEVATION = 18.0
# Another side than the front must show this much more to be preferred.
FRONT_BONUS = 1.15
# A vertex whose faces bend further than this from its normal lies on a crease.
SMOOTH_COSINE = math.cos(math.radians(40.0))
# Numbers of pieces are placed on a grid of so many cells; their size is this share of the room's
# radius. Smaller ones than the least nobody can read.
LABEL_CELLS = 200
LABEL_SHARE = 1.1
LEAST_LABEL = 7.0
LIGHT = np.array([-0.45, 0.65, 0.61])


def render_pair(data: MeshData, size: int = 800) -> Image.Image:
    """The shaded mesh on the left, its flattened charts with their numbers on the right.

    Args:
        data: a mesh with charts and texture coordinates.
        size: height of the picture in pixels; it is twice as wide.
    """
    canvas = np.empty((size, 2 * size, 3), dtype=np.uint8)
    # NumPy lets other threads work while it does.
    with ThreadPoolExecutor(1) as pool:
        mesh = pool.submit(_mesh_panel, data, size)
        canvas[:, size:], labels = _pattern_panel(data, size)
        canvas[:, :size] = mesh.result()
    image = Image.fromarray(canvas)
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
    panels = [_mesh_panel(one, size) for one in data]
    canvas = np.full((size + foot, size * len(panels), 3), 255, dtype=np.uint8)
    canvas[:size] = np.concatenate(panels, axis=1)
    image = Image.fromarray(canvas)
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


def _fit(points: np.ndarray, size: int) -> np.ndarray:
    """Points (any shape, last axis x y with y up), centred in a square image with y down."""
    sides = points[..., 0].ravel(), points[..., 1].ravel()
    low, high = (np.array([end(side) for side in sides]) for end in (np.min, np.max))
    extent = float((high - low).max()) or 1.0
    scaled = (points - (low + high) / 2) * (size * (1 - 2 * MARGIN) / extent)
    return scaled * np.array([1.0, -1.0]) + size / 2


def _mesh_panel(data: MeshData, size: int) -> np.ndarray:
    rotation = view_rotation(data.vertices, data.faces)
    # Far from the origin, differences would drown in large coordinates.
    seen = (data.vertices - data.vertices[data.faces[0, 0]]) @ rotation.T
    corners = seen[data.faces]
    points = _fit(seen[:, :2], size)[data.faces]
    visible = rasterize(points, -corners[:, :, 2], size, size)
    lit = np.zeros(len(data.faces), dtype=bool)
    lit[visible.shown] = True
    light = _corner_light(seen, data.faces, lit)
    face_of = (np.cumsum(lit) - 1)[visible.shown]
    inside = visible.barycentric()
    brightness, gloss = (
        np.einsum("pk,pk->p", inside, part.astype(np.float32)[face_of]) for part in light
    )
    color = data.colors.astype(np.float32)[visible.shown] * brightness[:, None]
    color = np.clip(color + gloss[:, None], 0, 1)
    return _compose(points, visible, _charts(visible, data), color, data)


def _pattern_panel(data: MeshData, size: int) -> tuple[np.ndarray, list[_Label]]:
    points = _fit(data.texcoords, size)
    visible = rasterize(points, None, size, size)
    color = data.colors.astype(np.float32)[visible.shown]
    charts = _charts(visible, data)
    return _compose(points, visible, charts, color, data), _labels(charts)


def _charts(visible: Visible, data: MeshData) -> np.ndarray:
    """The chart that each pixel shows, -1 for background."""
    charts = np.full(visible.triangle.shape, -1, dtype=np.int32)
    charts.ravel()[visible.pixels] = data.charts[visible.shown]
    return charts


def _compose(
    points: np.ndarray, visible: Visible, charts: np.ndarray, color: np.ndarray, data: MeshData
) -> np.ndarray:
    """Colours of the visible pixels on white, with lines around charts and along seams: bytes."""
    line = _soft(_changes(charts)).ravel()
    near, darkness = _edge_lines(points, visible, data.seams)
    line[near] = np.maximum(line[near], darkness)
    image = np.full((line.size, 3), 255, dtype=np.uint8)
    image[visible.pixels] = (color * 255 + 0.5).astype(np.uint8)
    inked = np.flatnonzero(line[visible.pixels])
    for pixels, below in (
        (np.flatnonzero((line > 0) & (charts.ravel() < 0)), np.ones(3, dtype=np.float32)),
        (visible.pixels[inked], color[inked]),
    ):
        shade = below + line[pixels, None] * (INK - below)
        image[pixels] = (shade * 255 + 0.5).astype(np.uint8)
    return image.reshape(*charts.shape, 3)


def _corner_light(
    seen: np.ndarray, faces: np.ndarray, lit: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Brightness and highlight at the corners of the faces that are `lit`, each by 3.

    Corners have the normal of their vertex, or of their face where the vertex lies on a crease;
    faces that show their back are lit as their front.
    """
    corners = seen[faces]
    weighted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    of_face = _normalized(weighted)
    of_vertex = np.stack(
        [np.bincount(faces.ravel(), np.repeat(weighted[:, k], 3), len(seen)) for k in range(3)],
        axis=1,
    )
    of_corner = _normalized(of_vertex)[faces]
    # A vertex on a crease has no normal that serves both of its sides.
    cosine = np.einsum("fkx,fx->fk", of_corner, of_face)
    on_crease = np.zeros(len(seen), dtype=bool)
    on_crease[faces[cosine < SMOOTH_COSINE]] = True
    creased = on_crease[faces[lit]]
    of_face = of_face[lit]
    normals = np.where(creased[:, :, None], of_face[:, None, :], of_corner[lit])
    normals *= np.where(of_face[:, 2] < 0, -1.0, 1.0)[:, None, None]
    return _shade(normals)


def _normalized(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def _shade(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A key light from the upper left with light from the sky, and a soft highlight."""
    light = LIGHT / np.linalg.norm(LIGHT)
    key = np.clip(normals @ light, 0, 1)
    sky = 0.5 + 0.5 * normals[..., 1]
    half = light + np.array([0.0, 0.0, 1.0])
    gloss = np.clip(normals @ (half / np.linalg.norm(half)), 0, 1) ** 8
    return 0.5 + 0.16 * sky + 0.42 * key, 0.10 * (gloss * gloss * gloss * gloss * gloss)


def _edge_lines(
    points: np.ndarray, visible: Visible, edges: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Pixels of triangles with edges that are marked in #T by 3, and how dark they make them."""
    marked = np.asarray(edges.any(axis=1))
    near = np.flatnonzero(marked[visible.shown])
    inside = visible.barycentric(near)
    shown = (np.cumsum(marked) - 1)[visible.shown[near]]
    points, edges = points[marked], edges[marked]
    e1, e2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    area = np.abs(e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
    line = np.zeros(len(near), dtype=np.float32)
    for k in range(3):
        length = np.linalg.norm(points[:, (k + 1) % 3] - points[:, k], axis=1)
        # The corner opposite of the edge from k to k+1 is k+2.
        height = area / np.where(length > 0, length, 1)
        distance = inside[:, (k + 2) % 3] * height[shown]
        darkness = np.clip(LINE + 0.5 - distance, 0, 1) * edges[shown, k]
        line = np.maximum(line, darkness)
    return visible.pixels[near], line


def _changes(image: np.ndarray) -> np.ndarray:
    """Pixels that differ from the one to their right or below: lines of one pixel.

    Where triangles are smaller than a pixel, the distance to their own edges misses lines.
    """
    changes = np.zeros(image.shape, dtype=bool)
    changes[:, :-1] = image[:, :-1] != image[:, 1:]
    changes[:-1] |= image[:-1] != image[1:]
    return changes


def _soft(mask: np.ndarray) -> np.ndarray:
    """A mask with soft edges, from 0 to 1; nothing comes in from outside of the image."""
    soft = mask.astype(np.uint8)  # sixteenths, at the end
    for axis in (0, 1):
        sums = 2 * soft
        # Views along this axis: both neighbours of a pixel weigh half of it.
        into, out_of = np.moveaxis(sums, axis, 0), np.moveaxis(soft, axis, 0)
        into[1:] += out_of[:-1]
        into[:-1] += out_of[1:]
        soft = sums
    # Only so many values.
    return np.minimum(SOFT_LINE * np.arange(17, dtype=np.float32) / 16, 1)[soft]


@dataclass(frozen=True)
class _Label:
    """A piece's number and the largest disk of the piece found for it, in finished pixels."""

    text: str
    x: float
    y: float
    radius: float


def _labels(charts: np.ndarray) -> list[_Label]:
    """The innermost pixel of every chart, by peeling layers off the charts' pixels.

    Charts that are too small for a number that can be read are left out.
    """
    step = max(1, len(charts) // LABEL_CELLS)
    image = charts[step // 2 :: step, step // 2 :: step]
    layers = np.zeros(image.shape, dtype=np.int64)
    inside = image >= 0
    padded = np.pad(image, 1, constant_values=-1)
    for row, column in ((0, 1), (2, 1), (1, 0), (1, 2)):
        inside &= padded[row : row + image.shape[0], column : column + image.shape[1]] == image
    layers += image >= 0
    while inside.any():
        layers += inside
        # What is inside has neighbours of its own chart only.
        core = inside.copy()
        core[1:] &= inside[:-1]
        core[:-1] &= inside[1:]
        core[:, 1:] &= inside[:, :-1]
        core[:, :-1] &= inside[:, 1:]
        inside = core
    order = np.argsort(image.ravel(), kind="stable")
    starts = np.flatnonzero(np.diff(image.ravel()[order], prepend=-2))
    deepest = np.maximum.reduceat(layers.ravel()[order], starts)
    labels = []
    for pixels, depth in zip(np.split(order, starts[1:]), deepest, strict=True):
        chart = image.flat[pixels[0]]
        radius = (depth - 0.5) * step
        if chart < 0 or radius * LABEL_SHARE < LEAST_LABEL:
            continue
        place = np.stack(np.divmod(pixels, image.shape[1]), axis=1) + 0.5
        # Of the pixels that lie about as deep, the one nearest to the middle.
        off_center = np.linalg.norm(place - place.mean(axis=0), axis=1)
        chosen = np.argmin(np.where(layers.flat[pixels] >= 0.8 * depth, off_center, np.inf))
        y, x = place[chosen] * step
        labels.append(_Label(str(chart + 1), x, y, radius))
    return labels


def _draw_numbers(image: Image.Image, labels: list[_Label], origin: tuple[int, int]) -> None:
    draw = ImageDraw.Draw(image)
    fill = tuple(int(255 * part) for part in INK)
    for label in labels:
        size = round(min(LABEL_SHARE * label.radius, 0.035 * image.height))
        position = (origin[0] + label.x, origin[1] + label.y)
        draw.text(position, label.text, fill=fill, font=_font(size), anchor="mm")


@functools.cache
def _font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size=size)
