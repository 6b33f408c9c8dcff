"""Papercraft: from a mesh to parts that fold exactly, on the command line and in pymeshlab."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import meshes
from devseg.cli import main
from devseg.load import load_mesh

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


# The corners of a cube of side 2, and the sides of its base and its top with their walls.
CUBE = (
    [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)],
    [
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [1, 3, 7], [1, 7, 5], [3, 2, 6], [3, 6, 7], [2, 0, 4], [2, 4, 6],
    ],
)  # fmt: skip


def folded(obj: Callable, out: Path, mesh: tuple, *options: str) -> dict:
    """What `devseg run --method papercraft` tells of a mesh."""
    path = str(obj(mesh, "model"))
    assert main(["run", path, "-o", str(out), "--method", "papercraft", *options]) == 0
    return json.loads((out / "model.json").read_text())


def layers(drawing: str) -> dict[str, list[str]]:
    """The paths of each layer of an SVG."""
    parts = re.split(r'<g id="([a-z]+)" inkscape:groupmode="layer"', drawing)
    return {
        name: re.findall(r' d="([^"]*)"', body)
        for name, body in zip(parts[1::2], parts[2::2], strict=True)
    }


def test_polyhedra_unfold_as_they_are(obj: Callable, tmp_path: Path) -> None:
    points, faces = np.array(CUBE[0], float), np.array(CUBE[1])
    result = folded(obj, tmp_path, (points, faces), "--mm-per-unit", "20")
    assert result["parametrization"]["charts_number"] == 1
    assert result["method_results"]["nets_number"] == 1
    assert result["deformation"]["largest_displacement"] == 0
    assert result["segmentation"]["seam_length"] == pytest.approx(14)  # 7 of 12 edges
    always = folded(obj, tmp_path / "b", (points, faces), "--deform", "always")
    assert always["method_results"]["nets_number"] == 0
    ball = folded(obj, tmp_path / "c", meshes.sphere(), "--deform", "never", "--formats", "ply")
    assert "deformation" not in ball
    assert ball["parametrization"]["l2_stretch"] == pytest.approx(1, abs=1e-9)


def test_displacements_keep_their_bounds(meshset: Callable) -> None:
    ms = meshset(meshes.sphere())
    ms.apply_filter(SEGMENT, charts_number=4, deform="Always")
    diagonal = ms.current_mesh().bounding_box().diagonal()
    moved = ms.apply_filter(DEFORM, max_displacement=0.02, max_mean_displacement=0.002)
    assert moved["converged"]
    assert moved["added_slits_number"] > 0
    assert moved["largest_displacement"] <= 0.02 * diagonal
    assert moved["mean_displacement"] <= 0.002 * diagonal
    assert residual(ms.current_mesh()) < 1e-6


def test_folds_are_lines_strokes_or_cuts(obj: Callable, tmp_path: Path) -> None:
    mesh = np.array(CUBE[0], float), np.array(CUBE[1])

    def drawn(*options: str) -> dict[str, list[str]]:
        folded(obj, tmp_path, mesh, "--mm-per-unit", "20", "--formats", "svg", *options)
        return layers((tmp_path / "model.svg").read_text())

    lines = drawn("--tabs", "none")
    assert len(lines["mountain"][0].split("M")) - 1 == 5  # the folds of a net of a cube
    assert "valley" not in lines
    tabs = drawn()
    assert len(tabs["mountain"][0].split("M")) - 1 == 5 + 7
    perforated = drawn("--tabs", "none", "--perforation", "3,1")
    assert "mountain" not in perforated
    assert len(perforated["perforation"][0].split("M")) - 1 == 5 * 9  # of 40 mm
    outside = drawn("--tabs", "none", "--fold-marks", "outside")
    assert 0 < len(outside["mountain"][0].split("M")) - 1 <= 10
    assert "mountain" not in drawn("--tabs", "none", "--fold-marks", "none")
    assert drawn("--tabs", "none", "--perforation", "3,1")["cut"] == lines["cut"]
    shadows = drawn("--tab-shadows")
    assert 0 < len(shadows["shadow"][0].split("M")) - 1 <= 7


def test_pieces_fit_the_page_if_asked(obj: Callable, tmp_path: Path, fails: Callable) -> None:
    mesh = np.array(CUBE[0], float), np.array(CUBE[1])
    options = ("--mm-per-unit", "60", "--formats", "pdf", "--page", "a4", "--no-tiling")
    path = obj(mesh, "model")
    fails("run", path, "-o", tmp_path / "a", "--method", "papercraft", *options)
    folded(obj, tmp_path, mesh, *options, "--fit-page")
    assert "--fit-page" in fails(
        "run", path, "-o", tmp_path / "b", "--formats", "svg", "--fit-page"
    )


def test_mirrored_folds_turn_over(obj: Callable, tmp_path: Path) -> None:
    mesh = np.array(CUBE[0], float), np.array(CUBE[1])
    options = ("--mm-per-unit", "20", "--formats", "svg", "--mirror")
    folded(obj, tmp_path, mesh, *options)
    drawn = layers((tmp_path / "model.svg").read_text())
    assert "mountain" not in drawn
    assert len(drawn["valley"][0].split("M")) - 1 == 5 + 7


def test_rims_are_simplified_and_holes_closed(obj: Callable, tmp_path: Path) -> None:
    points, faces = meshes.sphere()
    open_faces = faces[points[faces].mean(axis=1)[:, 2] < 0.9 * points[:, 2].max()]
    target = ("--target-faces", "150", "--formats", "ply", "--no-picture")
    result = folded(obj, tmp_path, (points, open_faces), *target)
    assert result["simplification"]["mean_deviation"] < 0.01
    closed = folded(obj, tmp_path / "b", (points, open_faces), "--close-holes", *target)
    assert closed["simplification"]["faces"] <= 150
    assert rim_edges(faces_of(tmp_path / "b" / "model.ply")) == 0
    assert 0 < rim_edges(faces_of(tmp_path / "model.ply")) < 0.5 * rim_edges(open_faces)


def faces_of(path: Path) -> np.ndarray:
    """The faces of a file, #F by 3."""
    return load_mesh(path).meshes.current_mesh().face_matrix()


def rim_edges(faces: np.ndarray) -> int:
    """Edges that have one face."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return int((np.unique(edges, axis=0, return_counts=True)[1] == 1).sum())
