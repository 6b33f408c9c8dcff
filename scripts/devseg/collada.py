"""What a Collada file says beside its triangles, and strips, fans and polygons as triangles.

The host makes one mesh of the whole scene, without names, and passes over what is neither triangles
nor lists of polygons.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote, unquote

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    import numpy as np

_READ = ("triangles", "polylist")  # by the host
_OTHERS = ("tristrips", "trifans", "polygons")
_LINES = ("lines", "linestrips")
_DEEPEST = 64  # nodes within each other; a file may name itself


@dataclass(frozen=True)
class Run:
    """Triangles of one object and material that follow each other; their number."""

    object: str
    material: str
    triangles: int


def rewritten(path: Path, folder: Path) -> tuple[Path, list[str]]:
    """A file that holds the same in triangles, for the host; the file itself where that reads it.

    Returns:
        The file, and notes on what was left out.
    """
    from xml.etree.ElementTree import ElementTree

    root = _root(path)
    if root is None:
        return path, []
    kinds = {_kind(element) for element in root.iter()}
    notes = ["lines of the file were left out"] if kinds.intersection(_LINES) else []
    if not kinds.intersection(_OTHERS):
        return path, notes
    for element in root.iter():
        element.tag = _kind(element)  # the host knows no prefixes
        if element.tag in _OTHERS:
            _make_triangles(element)
        elif element.tag == "init_from" and element.text and "://" not in element.text:
            place = os.path.relpath(path.parent / unquote(element.text.strip()), folder)
            element.text = quote(place)
    target = folder / path.name
    ElementTree(root).write(target, encoding="utf-8", xml_declaration=True)
    return target, notes


def runs(path: Path) -> list[Run]:
    """All triangles in the order of the host: through the nodes, a node before its children."""
    root = _root(path)
    if root is None:
        return []
    return list(_Scene(root).runs())


def material_colors(path: Path) -> dict[str, tuple[float, float, float]]:
    """Red, green and blue of each material by its name, where it has one colour."""
    root = _root(path)
    if root is None:
        return {}
    scene = _Scene(root)
    colors = {}
    for material in scene.all("material"):
        effect = scene.named.get(_reference(_first(material, "instance_effect")))
        color = _first(_first(effect, "diffuse"), "color")
        if color is not None and color.text:
            red, green, blue = map(float, color.text.split()[:3])
            colors[_name(material)] = (red, green, blue)
    return colors


class _Scene:
    """A document whose elements are found by their ids."""

    def __init__(self, root: Element) -> None:
        self.root = root
        self.named = {e.get("id"): e for e in root.iter() if e.get("id")}

    def all(self, kind: str) -> list[Element]:
        return [element for element in self.root.iter() if _kind(element) == kind]

    def runs(self) -> Iterator[Run]:
        shown = [self.named.get(_reference(e)) for e in self.all("instance_visual_scene")]
        for scene in shown:
            if scene is not None:
                yield from self._below(scene, 0)

    def _below(self, parent: Element, depth: int) -> Iterator[Run]:
        if depth > _DEEPEST:
            return
        for child in parent:
            if _kind(child) == "instance_geometry":
                yield from self._of_geometry(parent, child)
        for child in parent:
            instance = _kind(child) == "instance_node"
            node = self.named.get(_reference(child)) if instance else child
            if node is not None and _kind(node) == "node":
                yield from self._below(node, depth + 1)

    def _of_geometry(self, node: Element, instance: Element) -> Iterator[Run]:
        geometry = self.named.get(_reference(instance))
        bound = {
            e.get("symbol", ""): self.named.get(e.get("target", "").lstrip("#"))
            for e in instance.iter()
            if _kind(e) == "instance_material"
        }
        for element in geometry.iter() if geometry is not None else ():
            if _kind(element) in (*_READ, *_OTHERS):
                symbol = element.get("material", "")
                material = bound.get(symbol)
                name = _name(material) if material is not None else symbol
                yield Run(_name(node), name, _count(element))


def _count(element: Element) -> int:
    """Triangles of an element, those left out that repeat a vertex."""
    if _kind(element) == "polylist":
        counts = _first(element, "vcount")
        sizes = (counts.text or "").split() if counts is not None else []
        return sum(max(int(size) - 2, 0) for size in sizes)
    a, b, c = _triangles(element)[:, :, _strides(element)[1]].T
    return int(((a != b) & (b != c) & (c != a)).sum())


def _strides(element: Element) -> tuple[int, int]:
    """Numbers of each corner, and which of them is the vertex."""
    inputs = [e for e in element if _kind(e) == "input"]
    offsets = {e.get("semantic"): int(e.get("offset", "0")) for e in inputs}
    return max(offsets.values(), default=0) + 1, offsets.get("VERTEX", 0)


def _triangles(element: Element) -> np.ndarray:
    """#T by 3 by the numbers of each corner."""
    import numpy as np

    stride, _ = _strides(element)
    found = []
    for p in element:
        if _kind(p) != "p":
            continue
        corners = np.array((p.text or "").split(), dtype=np.int64)
        corners = corners[: len(corners) // stride * stride].reshape(-1, stride)
        if _kind(element) == "triangles":
            found.append(corners[: len(corners) // 3 * 3].reshape(-1, 3, stride))
        elif _kind(element) == "tristrips":
            strip = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
            strip[1::2] = strip[1::2][:, [0, 2, 1]]  # every other one is turned
            found.append(strip)
        else:
            first = np.broadcast_to(corners[:1], corners[2:].shape)
            found.append(np.stack([first, corners[1:-1], corners[2:]], axis=1))
    return np.concatenate(found) if found else np.zeros((0, 3, stride), np.int64)


def _make_triangles(element: Element) -> None:
    from xml.etree.ElementTree import SubElement

    triangles = _triangles(element)
    element.tag = "triangles"
    element.set("count", str(len(triangles)))
    for p in [child for child in element if _kind(child) in ("p", "ph")]:
        element.remove(p)
    p = SubElement(element, "p")
    p.text = " ".join(map(str, triangles.ravel().tolist()))


def _root(path: Path) -> Element | None:
    from xml.etree.ElementTree import ParseError, fromstring

    try:
        return fromstring(path.read_bytes())
    except ParseError:
        return None  # the host says what is wrong


def _kind(element: Element) -> str:
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""


def _name(element: Element) -> str:
    return element.get("name") or element.get("id") or ""


def _reference(element: Element | None) -> str:
    return element.get("url", "").lstrip("#") if element is not None else ""


def _first(element: Element | None, kind: str) -> Element | None:
    if element is None:
        return None
    return next((e for e in element.iter() if _kind(e) == kind), None)
