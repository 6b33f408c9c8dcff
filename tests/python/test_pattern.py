"""Patterns in pymeshlab: optimisation, the flat layer and the measures, on meshes from anywhere."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import meshes

DCHARTS = "compute_segmentation_dcharts_per_face"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"
OPTIMIZE = "apply_texcoord_pattern_optimization_per_wedge"
PIECES = "generate_pattern_pieces"
MEASURES = "get_pattern_measures"


def areas(mesh: Any) -> np.ndarray:
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    sides = corners[:, 1:] - corners[:, :1]
    return np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2.0


def test_a_segmented_mesh_becomes_a_layer_with_a_map_back(meshset: Callable) -> None:
    ms = meshset(meshes.sphere(40, 20))
    ms.apply_filter(DCHARTS, charts_number=6)
    ms.apply_filter(FLATTEN)
    model = ms.current_mesh()
    result = ms.apply_filter(PIECES, mm_per_unit=40.0)
    assert ms.mesh_number() == 2
    layer = ms.current_mesh()
    assert layer.face_number() == model.face_number()
    vertices = layer.vertex_matrix()
    assert np.all(vertices[:, 2] == 0.0)
    # Outlines may differ from the charts where seams are matched, but not by much.
    extent = vertices.max(axis=0) - vertices.min(axis=0)
    assert extent[:2] == pytest.approx([result["width_mm"], result["height_mm"]], rel=0.1)
    source = layer.face_custom_scalar_attribute_array("source_face").astype(int)
    assert sorted(source) == list(range(model.face_number()))
    piece = layer.face_custom_scalar_attribute_array("piece_id").astype(int)
    assert set(piece) == set(range(result["pieces_number"]))
    # Each face of a chart lies in one piece, with nearly its area on the model.
    chart = model.face_custom_scalar_attribute_array("chart_id").astype(int)[source]
    assert len(set(zip(chart, piece, strict=True))) == result["pieces_number"]
    ms.set_current_mesh(0)
    measures = ms.apply_filter(MEASURES, mm_per_unit=40.0)
    assert areas(layer).sum() == pytest.approx(measures["area_mm2"], rel=2e-3)
    assert areas(layer).sum() == pytest.approx(1600.0 * areas(model).sum(), rel=0.1)


def test_seams_of_lpfb_agree(meshset: Callable) -> None:
    ms = meshset(meshes.sphere(40, 20))
    ms.apply_filter(DCHARTS, charts_number=6)
    ms.apply_filter(FLATTEN, method="LPFB")
    measures = ms.apply_filter(MEASURES, mm_per_unit=40.0)
    assert measures["mismatched_seams_number"] == 0
    assert measures["max_seam_mismatch_percent"] <= 0.2
    assert measures["max_seam_mismatch_mm"] <= 0.5
    assert len(measures["seam_length_mm"]) == measures["seams_number"]
    assert len(measures["piece_area_mm2"]) == measures["pieces_number"]


def test_optimisation_leaves_a_valid_layout(meshset: Callable) -> None:
    ms = meshset(meshes.sphere(40, 20))
    ms.apply_filter(DCHARTS, charts_number=8)
    ms.apply_filter(FLATTEN)
    before = ms.apply_filter("get_parametrization_measures")
    result = ms.apply_filter(OPTIMIZE, max_gusset_area=0.2)
    after = ms.apply_filter("get_parametrization_measures")
    assert after["charts_number"] == result["charts_number"]
    joined = before["charts_number"] - after["charts_number"]
    assert joined == result["reattached_charts_number"]
    assert after["flipped_faces_number"] == 0
    assert after["overlapping_faces_number"] == 0
    chart = ms.current_mesh().face_custom_scalar_attribute_array("chart_id")
    assert len(set(chart)) == result["charts_number"]


def test_any_textured_mesh_has_a_pattern(pymeshlab: ModuleType) -> None:
    folder = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
    path = folder / "bunny10k_textured.obj"
    if not path.exists():
        pytest.skip(f"this pymeshlab ships no {path.name}")
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(path))
    measures = ms.apply_filter(MEASURES, height_mm=300.0)
    assert measures["pieces_number"] > 0
    assert measures["seams_number"] > 0
    ms.apply_filter(PIECES, height_mm=300.0)
    assert ms.mesh_number() == 2


@pytest.mark.parametrize("name", [OPTIMIZE, PIECES, MEASURES])
def test_meshes_without_texture_are_refused(meshset: Callable, name: str) -> None:
    ms = meshset(meshes.sphere(10, 10))
    with pytest.raises(Exception, match="expected wedge texture coordinates, found none"):
        ms.apply_filter(name)
    assert ms.mesh_number() == 1


def test_scales_out_of_range_are_refused(meshset: Callable) -> None:
    ms = meshset(meshes.sphere(10, 10))
    ms.apply_filter(FLATTEN)
    for scale in (0.0, -1.0, float("nan")):
        with pytest.raises(Exception, match="mm_per_unit: expected"):
            ms.apply_filter(PIECES, mm_per_unit=scale)
    assert ms.mesh_number() == 1


@pytest.mark.parametrize("name", ["tshirt_8710.ply", "penguin_6720.ply", "bull_12396.ply"])
def test_seams_of_real_models_agree(pymeshlab: ModuleType, data: Path, name: str) -> None:
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(data / "public" / name))
    ms.apply_filter(DCHARTS)
    ms.apply_filter(FLATTEN, method="LPFB")
    scale = 600.0 / ms.current_mesh().bounding_box().diagonal()
    measures = ms.apply_filter(MEASURES, mm_per_unit=scale)
    assert measures["seams_number"] >= 4
    assert measures["mismatched_seams_number"] == 0
