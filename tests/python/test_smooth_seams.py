"""'Charts: Smooth Seams' in the host: the mesh it leaves, and all that was on the mesh before."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshes
from devseg import pipeline
from devseg.cli import main
from devseg.methods import METHODS
from devseg.pipeline import RunOptions, Session
from devseg.ply import _face_rows

FILTER = "meshing_smooth_chart_seams"


@pytest.fixture
def segmented(meshset: Callable[[meshes.Mesh], Any]) -> Any:
    ms = meshset(meshes.sphere(48, 24))
    ms.compute_segmentation_dcharts_per_face(charts_number=6)
    return ms


def sources(before: Any, after: Any) -> tuple[np.ndarray, np.ndarray]:
    """For each new face the old face that it lies in, and barycentric coordinates of its corners.

    Found from the positions alone: the host does not tell.
    """
    old, triangles = before.vertex_matrix(), before.face_matrix()
    corners = old[triangles]
    points = after.vertex_matrix()[after.face_matrix()]
    centers = points.mean(axis=1)
    found = np.empty(len(points), int)
    weights = np.empty((len(points), 3, 3))
    for i, center in enumerate(centers):
        near = np.argsort(np.linalg.norm(corners.mean(axis=1) - center, axis=1))[:30]
        for f in near:
            matrix = corners[f].T  # the origin is in no plane of a face of the sphere
            inside = np.linalg.solve(matrix, center)
            if abs(inside.sum() - 1) < 1e-6 and inside.min() > -1e-6:
                found[i] = f
                weights[i] = np.linalg.solve(matrix, points[i].T).T
                break
        else:
            raise AssertionError(f"face {i} lies on no old face")
    return found, weights


def test_a_bound_on_strain_is_kept(meshset: Callable[[meshes.Mesh], Any]) -> None:
    def made(**parameters: Any) -> tuple[dict[str, Any], float]:
        ms = meshset(meshes.sphere(48, 24))
        ms.compute_segmentation_dcharts_per_face(charts_number=6)
        results = ms.apply_filter(FILTER, **parameters) if parameters else {}
        ms.compute_texcoord_parametrization_charts_per_wedge(method="LPFB")
        return results, ms.get_parametrization_measures()["strain_99"]

    _, on_edges = made()
    bound = 1.04 * on_edges  # the filter takes each chart as it is: 3 % more than all at one scale
    free, strain = made(max_strain=1.0)
    assert free["kept_charts_number"] == 0
    assert strain > bound
    results, strain = made(max_strain=bound)
    assert results["kept_charts_number"] > 0
    assert strain <= bound


def test_everything_on_the_mesh_is_carried_over(segmented: Any) -> None:
    ms = segmented
    ms.compute_texcoord_parametrization_charts_per_wedge()
    mesh = ms.current_mesh()
    rng = np.random.default_rng(3)
    n, m = mesh.vertex_number(), mesh.face_number()
    linear = mesh.vertex_matrix() @ np.array([0.3, 0.5, 0.8])  # of the place: exact in between
    mesh.add_vertex_custom_scalar_attribute(linear, "height")
    mesh.add_vertex_custom_point_attribute(2 * mesh.vertex_matrix(), "twice")
    marks = rng.random(m)
    mesh.add_face_custom_scalar_attribute(marks, "mark")
    mesh.add_face_custom_point_attribute(rng.random((m, 3)), "arrow")
    ms.compute_scalar_by_function_per_vertex(q="x+2*y")
    ms.compute_color_by_function_per_vertex(x="128+100*x", y="10", z="128+100*z")
    ms.compute_color_by_function_per_face(r="128+100*x0", g="10", b="128+100*z0")
    ms.compute_selection_by_condition_per_face(condselect="x0>0.2")
    read: dict[str, Callable[[Any], np.ndarray]] = {
        "mark": lambda x: x.face_custom_scalar_attribute_array("mark"),
        "arrow": lambda x: x.face_custom_point_attribute_matrix("arrow"),
        "colour": lambda x: x.face_color_matrix(),
        "quality": lambda x: x.face_scalar_array(),
        "selection": lambda x: x.face_selection_array(),
    }
    ms.generate_copy_of_current_mesh()
    ms.set_current_mesh(0)
    before = ms.mesh(1)
    uv = before.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    old = {name: values(ms.mesh(0)) for name, values in read.items()}
    results = ms.apply_filter(FILTER)
    after = ms.current_mesh()
    assert after.face_number() == m + results["new_faces_number"] > m
    np.testing.assert_array_equal(after.vertex_matrix()[:n], before.vertex_matrix())
    of, weights = sources(before, after)
    np.testing.assert_array_equal(of[:m], np.arange(m))
    for name, values in read.items():
        np.testing.assert_array_equal(values(after), old[name][of], name)
    expected = np.einsum("fkj,fjc->fkc", weights, uv[of]).reshape(-1, 2)
    np.testing.assert_allclose(after.wedge_tex_coord_matrix(), expected, atol=1e-6)
    place = after.vertex_matrix()
    np.testing.assert_allclose(
        after.vertex_custom_scalar_attribute_array("height"),
        place @ np.array([0.3, 0.5, 0.8]),
        atol=1e-12,
    )
    twice = after.vertex_custom_point_attribute_matrix("twice")
    np.testing.assert_allclose(twice, 2 * place, atol=1e-12)
    np.testing.assert_allclose(
        after.vertex_scalar_array(), place[:, 0] + 2 * place[:, 1], atol=1e-6
    )
    red = after.vertex_color_matrix()[:, 0] * 255
    np.testing.assert_allclose(red, 128 + 100 * place[:, 0], atol=2)
    lengths = np.linalg.norm(after.vertex_normal_matrix()[n:], axis=1)
    np.testing.assert_allclose(lengths, 1, atol=1e-6)


def test_seams_are_shorter_and_charts_stay_disks(segmented: Any) -> None:
    before = segmented.get_segmentation_measures()
    results = segmented.apply_filter(FILTER)
    after = segmented.get_segmentation_measures()
    assert results["seam_length_before"] == pytest.approx(before["seam_length"])
    assert results["seam_length"] == pytest.approx(after["seam_length"])
    assert after["seam_length"] < 0.97 * before["seam_length"]
    assert after["charts_number"] == before["charts_number"]
    assert after["disk_charts_number"] == before["charts_number"]
    segmented.compute_texcoord_parametrization_charts_per_wedge()
    flat = segmented.get_parametrization_measures()
    assert flat["flipped_faces_number"] == flat["overlapping_faces_number"] == 0


@pytest.mark.parametrize(
    ("options", "smooth"),
    [
        ((), True),
        (("--preset", "laser"), True),
        (("--seams", "edges"), False),
        (("--preset", "papercraft"), False),
        (("--formats", "ply,obj"), False),
        (("--formats", "ply", "--seams", "smooth"), True),
        (("--method", "vsa"), False),
    ],
)
def test_run_smooths_patterns_to_sew_and_to_cut(
    obj: Callable, tmp_path: Path, options: tuple[str, ...], smooth: bool
) -> None:
    path = obj(meshes.sphere(24, 12))
    assert main(["run", str(path), "-o", str(tmp_path), "--charts", "5", *options]) == 0
    result = json.loads((tmp_path / "mesh.json").read_text())
    assert ("smoothing" in result) == smooth
    assert (FILTER in result["parameters"]) == smooth
    if smooth:
        assert result["smoothing"]["smooth_seams_number"] > 0


def test_parts_of_faces_have_the_colour_of_their_chart(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.sphere(24, 12))
    options = ["--formats", "ply", "--seams", "smooth", "--charts", "5", "--no-picture"]
    assert main(["run", str(path), "-o", str(tmp_path), *options]) == 0
    result = json.loads((tmp_path / "mesh.json").read_text())
    assert result["smoothing"]["new_faces_number"] > 0
    assert result["method_results"]["charts_number"] == result["segmentation"]["charts_number"]
    rows = _face_rows(tmp_path / "mesh.ply")
    assert rows is not None
    chart = rows["chart_id"].astype(int)
    color = np.stack([rows[name] for name in ("red", "green", "blue")], axis=1)
    for c in range(chart.max() + 1):
        assert len(np.unique(color[chart == c], axis=0)) == 1


def test_the_bound_on_charts_is_kept_while_seams_are_smoothed(tmp_path: Path) -> None:
    method = METHODS["dcharts"]
    options = RunOptions(tmp_path, method, {}, "lscm", ("svg",), {}, smooth_seams=True)
    session = Session(tmp_path, None)
    for bound, expected in ((1.02, {"max_chart_l2_stretch": 1.02}), (0.0, {})):
        session.parameters[method.filter] = {"max_chart_l2_stretch": bound}
        assert pipeline._smoothing(session, options) == expected
    session.parameters.clear()
    assert pipeline._smoothing(session, options) == {}


def test_seams_stay_on_edges_where_smooth_ones_break_a_bound(
    obj: Callable, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = obj(meshes.sphere())
    stretches = {}
    for seams in ("edges", "smooth"):
        folder = tmp_path / seams
        options = ["--seams", seams, "--max-l2-stretch", "1.0005"]
        assert main(["run", str(path), "-o", str(folder), *options]) == 0
        result = json.loads((folder / "mesh.json").read_text())
        stretches[seams] = result["parametrization"]["l2_stretch"]
    assert stretches["smooth"] == pytest.approx(stretches["edges"], rel=1e-9)
    assert "seams stay on edges" in capsys.readouterr().err
    assert "smoothing" not in result


def test_papercraft_refuses_smooth_seams(
    obj: Callable, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = obj(meshes.cube())
    with pytest.raises(SystemExit) as stopped:
        main(["run", str(path), "-o", str(tmp_path), "--method", "papercraft", "--seams", "smooth"])
    assert stopped.value.code == 2
    assert "--seams smooth does not apply to --method papercraft" in capsys.readouterr().err


def test_charts_of_one_colour_keep_one(segmented: Any) -> None:
    mesh = segmented.current_mesh()
    before = mesh.face_color_matrix(), mesh.face_custom_scalar_attribute_array("chart_id")
    segmented.apply_filter(FILTER)
    mesh = segmented.current_mesh()
    after = mesh.face_color_matrix(), mesh.face_custom_scalar_attribute_array("chart_id")
    for colours, chart in (before, after):
        for c in np.unique(chart):
            assert len(np.unique(colours[chart == c], axis=0)) == 1
    assert len(np.unique(after[0], axis=0)) == len(np.unique(before[0], axis=0)) > 1
