"""Patterns read by foreign readers (svgelements, lxml) and measured on paper."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from svgelements import SVG, Close, Line, Move
from svgelements import Path as SvgPath

import meshes

INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
SVG_NS = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def flattened(pymeshlab: Any) -> Any:
    """A tube of height 3 and radius 1 in several flat, packed pieces."""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(*meshes.cylinder(radius=1.0, height=3.0)))
    ms.compute_segmentation_dcharts_per_face(charts_number=4)
    ms.compute_seams_charts_to_disks_per_edge()
    ms.compute_texcoord_parametrization_charts_per_wedge()
    return ms


@pytest.fixture
def export(flattened: Any, tmp_path: Path) -> Callable[..., Path]:
    """As `save`, with all parameters of the filter."""

    def make(**parameters: Any) -> Path:
        path = tmp_path / "pattern.svg"
        flattened.apply_filter("export_pattern", output_file=str(path), **parameters)
        return path

    return make


@pytest.fixture
def save(flattened: Any, tmp_path: Path) -> Callable[..., Path]:
    def make(**parameters: Any) -> Path:
        path = tmp_path / "pattern.svg"
        flattened.save_current_mesh(str(path), **parameters)
        return path

    return make


def layers(path: Path) -> dict[str, Any]:
    """The layer elements by id."""
    root = etree.parse(str(path)).getroot()
    groups = root.iter(f"{SVG_NS}g")
    return {g.get("id"): g for g in groups if g.get(f"{INKSCAPE}groupmode") == "layer"}


def outlines(path: Path, layer: str = "cut") -> list[np.ndarray]:
    """Vertices in mm of the closed outlines of a layer, as svgelements reads them."""
    found = []
    # At 25.4 pixels to the inch a pixel is a millimetre.
    for element in SVG.parse(str(path), ppi=25.4, reify=True).elements():
        if isinstance(element, SvgPath) and element.values.get("id", "").endswith(f"-{layer}"):
            segments = list(element.segments())
            assert isinstance(segments[0], Move) and isinstance(segments[-1], Close)
            assert all(isinstance(s, Line) for s in segments[1:-1])
            found.append(np.array([(s.end.x, s.end.y) for s in segments[:-1]]))
    return found


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def surface(ms: Any) -> np.ndarray:
    """Area of every chart, in model units."""
    mesh = ms.current_mesh()
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    return np.bincount(charts, np.linalg.norm(normals, axis=1) / 2)


@pytest.mark.parametrize("mm_per_unit", [10.0, 37.5])
def test_outlines_enclose_the_flattened_area(
    save: Callable, flattened: Any, mm_per_unit: float
) -> None:
    polygons = outlines(save(mm_per_unit=mm_per_unit))
    expected = surface(flattened) * mm_per_unit**2
    assert len(polygons) == len(expected)
    found = [area(p) for p in polygons]
    np.testing.assert_allclose(sorted(found), sorted(expected), rtol=1e-3)


def test_height_sets_the_size(save: Callable, flattened: Any) -> None:
    # The tube is 3 units high.
    polygons = outlines(save(height_mm=120.0))
    assert sum(map(area, polygons)) == pytest.approx(surface(flattened).sum() * 40**2, rel=1e-3)


def test_paper_is_in_millimetres(save: Callable) -> None:
    path = save(mm_per_unit=20.0)
    root = etree.parse(str(path)).getroot()
    width, height = root.get("width"), root.get("height")
    assert width.endswith("mm") and height.endswith("mm")
    box = [float(v) for v in root.get("viewBox").split()]
    assert box == pytest.approx([0, 0, float(width[:-2]), float(height[:-2])], abs=1e-3)
    for polygon in outlines(path):
        assert polygon.min() >= 0
        assert (polygon <= np.array(box[2:])).all()


def test_check_square_is_true(save: Callable) -> None:
    drawn = SVG.parse(str(save(mm_per_unit=5.0)), ppi=25.4, reify=True)
    square = drawn.get_element_by_id("check-square")
    assert square is not None
    x0, y0, x1, y1 = square.bbox()
    assert (x1 - x0, y1 - y0) == pytest.approx((50, 50), abs=0.1)
    frame = drawn.get_element_by_id("frame").bbox()
    assert frame[2:] == pytest.approx((drawn.width, drawn.height), abs=1e-3)


def test_layers_are_as_cutters_want_them(save: Callable) -> None:
    found = layers(save(mm_per_unit=10.0, labels=True))
    assert {"cut", "scale", "text"} <= set(found)
    for layer in found.values():
        assert layer.get(f"{INKSCAPE}label")
        assert len(layer), "an empty layer"
    for path in found["cut"].iter(f"{SVG_NS}path"):
        stroke = path.get("stroke") or found["cut"].get("stroke")
        fill = path.get("fill") or found["cut"].get("fill")
        assert (stroke, fill) == ("#ff0000", "none")
    assert not any(True for _ in found["cut"].iter(f"{SVG_NS}style"))


def test_labels_can_be_left_out(save: Callable, flattened: Any) -> None:
    pieces = len(surface(flattened))
    text = layers(save(mm_per_unit=10.0, labels=True))["text"]
    assert len([t for t in text.iter(f"{SVG_NS}text") if t.text]) >= pieces
    assert "text" not in layers(save(mm_per_unit=10.0, labels=False))


def test_the_dialog_asks_for_the_most_used_parameters(save: Callable, pymeshlab: Any) -> None:
    assert outlines(save(height_mm=100.0, preset="Sewing", page="a4", fabric_width_mm=0.0))
    with pytest.raises(pymeshlab.PyMeshLabException, match="curve_mm"):
        save(curve_mm=0.0)


@pytest.mark.parametrize("parameters", [{"mm_per_unit": 0.0}, {"mm_per_unit": -1.0}])
def test_bad_scale_writes_no_file(
    parameters: dict[str, float], flattened: Any, pymeshlab: Any, tmp_path: Path
) -> None:
    path = tmp_path / "bad.svg"
    with pytest.raises(pymeshlab.PyMeshLabException):
        flattened.save_current_mesh(str(path), **parameters)
    assert not path.exists()


def test_mesh_without_texture_coordinates_is_refused(
    meshset: Any, pymeshlab: Any, tmp_path: Path
) -> None:
    ms = meshset(meshes.cube())
    with pytest.raises(pymeshlab.PyMeshLabException, match="texture coordinates"):
        ms.save_current_mesh(str(tmp_path / "none.svg"))


def test_texture_coordinates_from_elsewhere_are_exported(meshset: Any, tmp_path: Path) -> None:
    ms = meshset(meshes.cube())
    ms.compute_texcoord_parametrization_triangle_trivial_per_wedge(textdim=256)
    path = tmp_path / "foreign.svg"
    ms.save_current_mesh(str(path), mm_per_unit=10.0)
    assert sum(map(area, outlines(path))) == pytest.approx(600, rel=1e-3)


def test_every_page_has_its_size_and_its_check_square(export: Callable) -> None:
    path = export(preset="Sewing", page="a4", mm_per_unit=60.0)
    root = etree.parse(str(path)).getroot()
    pages = [
        tuple(float(page.get(key)) for key in ("x", "y", "width", "height"))
        for page in root.iter(f"{INKSCAPE}page")
    ]
    assert len(pages) > 2
    assert all(page[2:] == (210, 297) for page in pages)
    drawn = SVG.parse(str(path), ppi=25.4, reify=True)
    for number, (x, y, width, height) in enumerate(pages, 1):
        x0, y0, x1, y1 = drawn.get_element_by_id(f"check-square-{number}").bbox()
        assert (x1 - x0, y1 - y0) == pytest.approx((50, 50), abs=0.01)
        assert x <= x0 and x1 <= x + width and y <= y0 and y1 <= y + height


def test_a_pattern_on_one_page_is_as_large_as_the_page(export: Callable) -> None:
    path = export(page="a4", mm_per_unit=15.0)
    root = etree.parse(str(path)).getroot()
    assert (root.get("width"), root.get("height")) == ("210mm", "297mm")
    drawn = SVG.parse(str(path), ppi=25.4, reify=True)
    square = np.array(drawn.get_element_by_id("check-square").bbox())
    for polygon in outlines(path):
        low, high = polygon.min(axis=0), polygon.max(axis=0)
        assert (high < square[:2]).any() or (low > square[2:]).any(), "the square lies on a piece"


def test_frame_and_check_squares_can_be_left_out(export: Callable) -> None:
    for page in ("none", "a4"):
        assert "scale" in layers(export(page=page, mm_per_unit=15.0, frame=False))
        assert "check-square" not in export(
            page=page, mm_per_unit=15.0, scale_check=False
        ).read_text(encoding="utf-8")
        bare = export(page=page, mm_per_unit=15.0, frame=False, scale_check=False)
        assert "scale" not in layers(bare) and "cut" in layers(bare)


def test_a_piece_is_one_group(export: Callable) -> None:
    options = {"preset": "Sewing", "mm_per_unit": 30.0}
    flat = layers(export(**options))
    grouped = layers(export(**options, group="Piece"))
    names = {path.get("id")[:3] for path in flat["cut"].iter(f"{SVG_NS}path")}
    assert names and names <= set(grouped)
    for name in names:
        parts = {child.get("id") for child in grouped[name]}
        assert {f"{name}-cut-layer", f"{name}-sew-layer", f"{name}-text-layer"} <= parts
        assert any(text.text == name for text in grouped[name].iter(f"{SVG_NS}text"))
    count = {kind: sum(1 for _ in flat[kind].iter()) for kind in ("cut", "numbers", "notch")}
    for kind, elements in count.items():
        inside = [g for key, g in grouped.items() if key.endswith(f"-{kind}-layer")]
        assert sum(sum(1 for _ in group.iter()) - 1 for group in inside) == elements - 1


def test_texts_can_be_outlines(export: Callable) -> None:
    options = {"preset": "Sewing", "mm_per_unit": 30.0, "scale_check": False}
    written = export(**options).read_text("utf-8")
    drawn = export(**options, text="Paths")
    assert "<text" in written and "<text" not in drawn.read_text("utf-8")
    found = layers(drawn)
    names = len(re.findall(r">P\d+<", written))
    assert names >= 1 and len(found["text"]) >= names
    for path in found["text"]:
        assert path.get("d").startswith("M ") and path.get("d").endswith("Z")
