"""Patterns read by foreign readers (svgelements, lxml) and measured on paper."""

from __future__ import annotations

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
