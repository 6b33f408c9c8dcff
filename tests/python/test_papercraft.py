"""Papercraft: from a mesh to parts that fold exactly, on the command line and in pymeshlab."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import meshes
from devseg.cli import main

SEGMENT = "compute_segmentation_papercraft_per_face"
DEFORM = "apply_coord_developable_charts"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"


def residual(mesh: object) -> float:
    """Largest difference of an angle sum to 2 pi, over vertices inside of charts."""
    points, faces = mesh.vertex_matrix(), mesh.face_matrix()
    seams = mesh.face_custom_scalar_attribute_array("seam_edges").astype(int)
    sums = np.zeros(len(points))
    outer = np.zeros(len(points), bool)
    edges = np.sort(np.concatenate([faces, faces[:, [1, 2, 0]]], axis=0).reshape(2, -1).T, axis=1)
    found, counts = np.unique(edges, axis=0, return_counts=True)
    outer[found[counts == 1]] = True  # the mesh's boundary
    for k in range(3):
        a = points[faces[:, (k + 1) % 3]] - points[faces[:, k]]
        b = points[faces[:, (k + 2) % 3]] - points[faces[:, k]]
        cosine = (a * b).sum(axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
        np.add.at(sums, faces[:, k], np.arccos(cosine))
        cut = (seams >> k) & 1 == 1
        outer[faces[cut, k]] = outer[faces[cut, (k + 1) % 3]] = True
    assert not outer.all()
    return float(np.abs(sums - 2 * np.pi)[~outer].max())


def test_charts_are_deformed_until_they_unfold(meshset: Callable) -> None:
    ms = meshset(meshes.sphere())
    before = ms.current_mesh().vertex_matrix().copy()
    faces = ms.current_mesh().face_matrix().copy()
    segmented = ms.apply_filter(SEGMENT, charts_number=8)
    assert segmented["charts_number"] == 8
    assert residual(ms.current_mesh()) > 1e-3
    deformed = ms.apply_filter(DEFORM)
    mesh = ms.current_mesh()
    assert deformed["converged"]
    assert residual(mesh) < 1e-7
    assert np.array_equal(mesh.face_matrix(), faces)
    moved = np.linalg.norm(mesh.vertex_matrix() - before, axis=1)
    assert deformed["largest_displacement"] == pytest.approx(moved.max(), rel=1e-9)
    assert deformed["mean_displacement"] == pytest.approx(moved.mean(), rel=1e-9)
    flat = ms.apply_filter(FLATTEN)
    assert flat["developed_charts_number"] == flat["charts_number"]
    measured = ms.apply_filter("get_parametrization_measures")
    assert measured["l2_stretch"] == pytest.approx(1, abs=1e-8)
    assert measured["overlapping_faces_number"] == 0
    assert (
        measured["disk_charts_number"] + measured["holed_charts_number"]
        == measured["charts_number"]
    )


def test_mesh_stays_as_it_is_where_the_tolerance_is_not_reached(
    meshset: Callable, pymeshlab: ModuleType
) -> None:
    points, faces = meshes.sphere()
    noise = np.random.default_rng(1).normal(scale=0.01, size=points.shape)
    ms = meshset((points + noise, faces))
    before = ms.current_mesh().vertex_matrix().copy()
    few = {"adjust_slits": False, "max_iterations": 30}
    with pytest.raises(pymeshlab.PyMeshLabException, match="expected angle sums of 2 pi"):
        ms.apply_filter(DEFORM, **few)
    assert np.array_equal(ms.current_mesh().vertex_matrix(), before)
    best = ms.apply_filter(DEFORM, keep_unfinished=True, **few)
    assert not best["converged"]
    assert best["residual"] > 1e-6
    assert not np.array_equal(ms.current_mesh().vertex_matrix(), before)


def test_command_line_simplifies_deforms_and_writes_folds(
    obj: Callable, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    arguments = ["--method", "papercraft", "--charts", "4", "--target-faces", "200"]
    code = main(["run", str(obj(meshes.sphere(), "ball")), "-o", str(out), *arguments])
    assert code == 0
    printed = capsys.readouterr().out
    assert "200 faces" in printed
    assert "rad from developable" in printed
    result = json.loads((out / "ball.json").read_text())
    assert result["mesh"]["faces"] > 500
    assert result["simplification"]["faces"] == 200
    assert 0 < result["simplification"]["mean_deviation"] < 0.01
    assert result["deformation"]["residual"] < 1e-6
    assert result["parametrization"]["l2_stretch"] == pytest.approx(1, abs=1e-8)
    assert result["parameters"]["pattern"]["preset"] == "Papercraft"
    drawing = (out / "ball.svg").read_text()
    assert 'inkscape:label="Fold mountain"' in drawing
