"""Pattern files as foreign readers see them: lines and texts in millimetres, layer by layer."""

from __future__ import annotations

import math
import re
import shutil
import subprocess
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pypdf
from lxml import etree
from shapely import STRtree, set_precision
from shapely.geometry import LineString, MultiLineString, Polygon
from shapely.ops import unary_union
from svgelements import SVG, Close, CubicBezier, Line, Move
from svgelements import Path as SvgPath

INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
SVG_NS = "{http://www.w3.org/2000/svg}"
POINTS_PER_MM = 72 / 25.4


@dataclass
class Part:
    """A polyline."""

    name: str
    points: np.ndarray
    closed: bool

    @property
    def length(self) -> float:
        ring = np.vstack([self.points, self.points[:1]]) if self.closed else self.points
        return float(np.linalg.norm(np.diff(ring, axis=0), axis=1).sum())

    @property
    def area(self) -> float:
        x, y = self.points.T
        return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


@dataclass
class Layer:
    """What lies on one layer."""

    parts: list[Part] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)

    @property
    def rings(self) -> list[Part]:
        return [part for part in self.parts if part.closed]


def read_svg(path: Path) -> dict[str, Layer]:
    """Layers by id; y points down."""
    layers: dict[str, Layer] = {}
    root = etree.parse(str(path)).getroot()
    for group in root.iter(f"{SVG_NS}g"):
        if group.get(f"{INKSCAPE}groupmode") == "layer":
            texts = [t.text or "" for t in group.iter(f"{SVG_NS}text")]
            layers[group.get("id")] = Layer(texts=texts)
    # At 25.4 pixels to the inch a pixel is a millimetre.
    drawn = SVG.parse(str(path), ppi=25.4, reify=True)
    for name, layer in layers.items():
        for element in drawn.get_element_by_id(name).select():
            if isinstance(element, SvgPath):
                layer.parts += _svg_parts(element)
    return layers


def _svg_parts(element: SvgPath) -> Iterable[Part]:
    name = element.values.get("id", "")
    points: list[tuple[float, float]] = []
    for segment in element.segments():
        if isinstance(segment, Move):
            if points:
                yield Part(name, np.array(points), False)
            points = [(segment.end.x, segment.end.y)]
        elif isinstance(segment, Close):
            yield Part(name, np.array(points), True)
            points = []
        elif isinstance(segment, CubicBezier):
            controls = (segment.start, segment.control1, segment.control2, segment.end)
            points += _along_cubic([(p.x, p.y) for p in controls])
        else:
            assert isinstance(segment, Line)
            points.append((segment.end.x, segment.end.y))
    if points:
        yield Part(name, np.array(points), False)


def _along_cubic(controls: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Points along a cubic Bezier curve behind its start, close enough to measure lengths."""
    t = np.linspace(0, 1, 129)[1:, None]
    a, b, c, d = np.array(controls)
    s = 1 - t
    points = s**3 * a + 3 * s**2 * t * b + 3 * s * t**2 * c + t**3 * d
    return [(float(x), float(y)) for x, y in points]


_TOKEN = re.compile(rb"\((?:\\.|[^\\()])*\)|/[^\s/\[\]()<>]+|[^\s/\[\]()<>]+|[\[\]]")


def read_pdf(path: Path) -> dict[str, Layer]:
    """The drawing of a PDF, in its own millimetres: layers by their names for people."""
    reader = pypdf.PdfReader(path, strict=True)
    form = reader.pages[-1]["/Resources"]["/XObject"]["/Pattern"].get_object()
    names = {
        key.encode(): str(group.get_object()["/Name"])
        for key, group in form["/Resources"]["/Properties"].items()
    }
    layers: dict[str, Layer] = {}
    layer = Layer()
    stack: list[bytes] = []
    points: list[tuple[float, float]] = []

    def finish(closed: bool) -> None:
        nonlocal points
        if points:
            layer.parts.append(Part("", np.array(points), closed))
        points = []

    for token in _TOKEN.findall(form.get_data()):
        if token == b"BDC":
            layer = layers.setdefault(names[stack[-1]], Layer())
        elif token in (b"m", b"l"):
            if token == b"m":
                finish(False)
            points.append((float(stack[-2]), float(stack[-1])))
        elif token == b"c":
            x = [float(value) for value in stack[-6:]]
            points += _along_cubic([points[-1], (x[0], x[1]), (x[2], x[3]), (x[4], x[5])])
        elif token == b"h":
            finish(True)
        elif token == b"S":
            finish(False)
        elif token == b"Tj":
            layer.texts.append(re.sub(rb"\\(.)", rb"\1", stack[-1][1:-1]).decode("latin-1"))
        stack = [*stack[-8:], token]
    return layers


def read_dxf(path: Path) -> dict[str, Layer]:
    """Layers of a DXF by name, blocks resolved, after an audit without findings."""
    document = ezdxf.readfile(path)
    audit = document.audit()
    assert not audit.errors and not audit.fixes, (path, audit.errors, audit.fixes)
    layers: dict[str, Layer] = {}
    entities: list[Any] = []
    for entity in document.modelspace():
        entities += entity.virtual_entities() if entity.dxftype() == "INSERT" else [entity]
    for entity in entities:
        layer = layers.setdefault(entity.dxf.layer, Layer())
        if entity.dxftype() == "POLYLINE":
            points = np.array([(p.x, p.y) for p in entity.points()])
            layer.parts.append(Part("", points, entity.is_closed))
        elif entity.dxftype() == "LWPOLYLINE":
            layer.parts.append(Part("", np.array(entity.get_points("xy")), entity.closed))
        elif entity.dxftype() == "SPLINE":
            points = np.array([(p.x, p.y) for p in entity.flattening(1e-3)])
            layer.parts.append(Part("", points[:-1], entity.closed))
        elif entity.dxftype() == "TEXT":
            layer.texts.append(entity.dxf.text)
        elif entity.dxftype() == "LINE":
            ends = (entity.dxf.start, entity.dxf.end)
            layer.parts.append(Part("", np.array([(p.x, p.y) for p in ends]), False))
        elif entity.dxftype() == "POINT":
            layer.parts.append(Part("", np.array([tuple(entity.dxf.location)[:2]] * 2), False))
    return layers


def polygons(layer: Layer) -> dict[str, Polygon]:
    """The pieces of a cut layer of an SVG: outlines with their holes."""
    rings: dict[str, list[np.ndarray]] = {}
    for part in layer.rings:
        rings.setdefault(part.name, []).append(part.points)
    return {name: _polygon(parts) for name, parts in rings.items()}


def _polygon(rings: list[np.ndarray]) -> Polygon:
    """The largest ring with the others as its holes."""
    *holes, outline = sorted(rings, key=lambda ring: Polygon(ring).area)
    return Polygon(outline, holes)


def overlap_of_itself(ring: Part) -> float:
    """Area in mm² that an outline encloses more than once, or on the wrong side."""
    return abs(Polygon(ring.points).buffer(0).area - ring.area)


def largest_overlap(shapes: list[Polygon]) -> float:
    """Largest area in mm² that two of the shapes share."""
    clean = [shape.buffer(0) for shape in shapes]
    tree = STRtree(clean)
    shared = [0.0]
    for i, shape in enumerate(clean):
        shared += [shape.intersection(clean[j]).area for j in tree.query(shape) if j > i]
    return max(shared)


def length_cut_twice(layer: Layer, grid: float = 0.01) -> float:
    """Length in mm of lines that lie on others."""
    lines = []
    for part in layer.parts:
        ring = np.vstack([part.points, part.points[:1]]) if part.closed else part.points
        lines.append(set_precision(LineString(ring), grid, mode="pointwise"))
    total = sum(line.length for line in lines)
    return float(total - unary_union(MultiLineString(lines)).length)


def wrong_counts(texts: list[str], seams: int, unnumbered: int = 0) -> dict[int, int]:
    """Seam numbers that are not written twice, or once at darts; none on so many seams."""
    counts = Counter(int(text) for text in texts)
    wrong = {n: counts[n] for n in range(1, seams + 1) if counts[n] not in (1, 2)}
    missing = [n for n, count in wrong.items() if count == 0]
    return {n: c for n, c in wrong.items() if c} if len(missing) == unnumbered else wrong


def words_outside(path: Path, pages: int) -> list[str]:
    """Words that stick out of the first pages of a PDF, as poppler sees them.

    Poppler also tells of words that a window cuts off, so that pages of tiles say nothing.
    """
    command = ["pdftotext", "-bbox", "-l", str(pages), str(path), "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    outside = []
    width = height = math.inf
    for line in done.stdout.splitlines():
        if page := re.search(r'<page width="([\d.]+)" height="([\d.]+)"', line):
            width, height = float(page[1]), float(page[2])
        elif word := re.search(r'<word xMin="(.*?)" yMin="(.*?)" xMax="(.*?)" yMax="(.*?)">', line):
            x0, y0, x1, y1 = map(float, word.groups())
            if min(x0, y0) < 0 or x1 > width or y1 > height:
                outside.append(line)
    return outside


def renders(path: Path) -> bool:
    """Whether the usual programs draw the file; True where they are not installed."""
    svg = ["rsvg-convert", "--width", "300", str(path)]
    pdf = ["pdftocairo", "-png", "-r", "20", "-singlefile", str(path), "-"]
    command = svg if path.suffix == ".svg" else pdf
    if shutil.which(command[0]) is None:
        return True
    return subprocess.run(command, capture_output=True, check=False).returncode == 0
