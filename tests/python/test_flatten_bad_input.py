"""Every flattening method on bad meshes: a valid layout, or a refusal that changes nothing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import meshes
from devseg.load import load_mesh

FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"
METHODS = ["Symmetric Dirichlet", "LSCM", "ABF++", "ARAP", "LPFB", "LPFB Even Areas"]

# What the evaluator counts of them needs no allowance.
VALID = ["zero_area_faces.ply", "needles_aspect_1e5.ply", "real_degtri.off", "single_triangle.obj"]
VALID += ["cube_12.obj", "tetrahedron.obj", "forty_holes.ply", "torus.ply", "cone_closed.ply"]
VALID += ["scale_1e-9.ply", "scale_1e9.ply", "far_from_origin.ply", "self_crossing_strip.ply"]
VALID += ["bowtie_vertex.ply", "nonmanifold_edge.ply", "three_fins.obj", "t_junctions.ply"]
# One-sided, or with faces that are turned over: the sign of a face's area in the plane says nothing
# there, but a face that is flipped against its neighbours lies on them.
UNORIENTED = ["moebius.ply", "mixed_orientation.ply", "real_blobby_shuffled.off"]
WITHOUT_AREA = ["all_collinear.obj", "all_same_point.obj"]


def evaluated(evaluator: ModuleType, meshset: Any) -> dict[str, Any]:
    mesh = meshset.current_mesh()
    uv = mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    assert np.isfinite(uv).all()
    assert uv.min() >= 0.0 and uv.max() <= 1.0
    ids = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    return evaluator.evaluate(mesh.vertex_matrix(), mesh.face_matrix(), uv, ids)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", VALID + UNORIENTED)
def test_layouts_are_valid(
    name: str, method: str, data: Path, evaluator: ModuleType, pymeshlab: ModuleType
) -> None:
    meshset = load_mesh(data / "bad" / name).meshes
    meshset.apply_filter(FLATTEN, method=method)
    theirs = evaluated(evaluator, meshset)
    assert theirs["disks"] == theirs["charts"]
    assert theirs["self_overlapping_charts"] == 0
    assert theirs["overlap_inter_frac"] < 1e-6
    assert theirs["degenerate_uv"] == 0
    if name not in UNORIENTED:
        assert theirs["flipped"] == 0
    ours = meshset.apply_filter("get_parametrization_measures")
    assert ours["flipped_faces_number"] == 0
    assert ours["overlapping_faces_number"] == 0
    assert ours["charts_number"] == theirs["charts"]


def wedges(meshset: Any) -> np.ndarray:
    return meshset.current_mesh().wedge_tex_coord_matrix().copy()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_refusal_names_the_face_and_changes_nothing(
    bad: float, method: str, meshset: Callable, pymeshlab: ModuleType
) -> None:
    flat = meshset(meshes.cylinder(around=12, along=4))
    flat.apply_filter(FLATTEN)
    before = wedges(flat)
    assert np.ptp(before) > 0.1
    mesh = flat.current_mesh()
    vertices, faces = mesh.vertex_matrix(), mesh.face_matrix()
    vertices[17, 1] = bad
    first = np.nonzero((faces == 17).any(axis=1))[0][0]
    broken = meshset((vertices, faces))
    broken.add_mesh(
        pymeshlab.Mesh(vertex_matrix=vertices, face_matrix=faces, w_tex_coords_matrix=before)
    )
    kept = wedges(broken)
    np.testing.assert_array_equal(kept, before)
    with pytest.raises(pymeshlab.PyMeshLabException, match=f"first face {first}\\b"):
        broken.apply_filter(FLATTEN, method=method)
    np.testing.assert_array_equal(wedges(broken), kept)
    with pytest.raises(pymeshlab.PyMeshLabException):
        broken.current_mesh().face_custom_scalar_attribute_array("chart_id")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", WITHOUT_AREA)
def test_meshes_without_area_are_refused(
    name: str, method: str, data: Path, pymeshlab: ModuleType
) -> None:
    meshset = load_mesh(data / "bad" / name).meshes
    before = wedges(meshset) if meshset.current_mesh().has_wedge_tex_coord() else None
    with pytest.raises(pymeshlab.PyMeshLabException, match="expected a surface, found"):
        meshset.apply_filter(FLATTEN, method=method)
    after = wedges(meshset) if meshset.current_mesh().has_wedge_tex_coord() else None
    np.testing.assert_array_equal(after, before)
