"""Arrays in and out: what comes back, what is refused, progress, cancelling, converters."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import devseg
import meshes
from conftest import ROOT
from devseg import host
from devseg.observer import Observation, observed

BALL = meshes.sphere()
TUBE = meshes.cylinder()


@pytest.fixture(scope="module")
def atlas() -> devseg.Atlas:
    return devseg.unwrap(*TUBE)


def areas(corners: np.ndarray) -> np.ndarray:
    """Of triangles, #F by 3 by 2, positive where they are not flipped."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2


def test_charts_are_a_partition_and_both_sides_agree_about_seams() -> None:
    charts = devseg.segment(*BALL, charts_number=6)
    assert charts.chart_id.shape == (len(BALL[1]),) and charts.seam_edges.dtype == bool
    assert set(charts.chart_id) == set(range(charts.charts_number))
    assert charts.measures["charts_number"] == charts.charts_number >= 2
    sides: dict[frozenset[int], set[tuple[bool, bool]]] = {}
    borders: dict[frozenset[int], set[int]] = {}
    for face, (corners, cut) in enumerate(zip(charts.faces, charts.seam_edges, strict=True)):
        for k in range(3):
            edge = frozenset((int(corners[k]), int(corners[(k + 1) % 3])))
            sides.setdefault(edge, set()).add(bool(cut[k]))
            borders.setdefault(edge, set()).add(int(charts.chart_id[face]))
    assert all(len(flags) == 1 for flags in sides.values())
    assert all(True in sides[edge] for edge, found in borders.items() if len(found) == 2)


def test_an_atlas_is_flat_to_scale_and_in_the_unit_square(atlas: devseg.Atlas) -> None:
    flat = areas(atlas.uv)
    assert atlas.uv.shape == (len(TUBE[1]), 3, 2) and (flat > 0).all()
    assert atlas.uv.min() >= 0 and atlas.uv.max() <= 1
    corners = TUBE[0][TUBE[1]]
    curved = np.linalg.norm(np.cross(*(corners[:, k] - corners[:, 0] for k in (1, 2))), axis=1) / 2
    scale = flat.sum() / curved.sum()
    assert np.allclose(flat, scale * curved, rtol=0.02)
    assert atlas.measures["l2_stretch"] < 1.01 and atlas.measures["flipped_faces_number"] == 0


@pytest.mark.parametrize("floats", [np.float32, np.float64])
@pytest.mark.parametrize("integers", [np.int32, np.int64, np.uint16])
def test_any_array_is_taken_and_none_is_changed(floats: type, integers: type) -> None:
    wide = np.zeros((2 * len(TUBE[0]), 5), dtype=floats, order="F")
    wide[::2, 1:4] = TUBE[0]
    vertices, faces = wide[::2, 1:4], np.asfortranarray(TUBE[1].astype(integers))
    before = wide.copy(), faces.copy()
    wide.flags.writeable = faces.flags.writeable = False
    found = devseg.unwrap(vertices, faces)
    assert (wide == before[0]).all() and (faces == before[1]).all()
    assert found.vertices.dtype == np.float64 and (found.vertices == vertices).all()
    assert (found.faces == TUBE[1]).all()
    assert not np.shares_memory(found.vertices, wide)


def test_lists_are_taken_as_well_and_the_result_is_the_same() -> None:
    one = devseg.unwrap(*meshes.cube())
    two = devseg.unwrap(*(a.tolist() for a in meshes.cube()))
    assert (one.uv == two.uv).all() and (one.chart_id == two.chart_id).all()


def test_the_functions_give_what_the_filters_give(
    atlas: devseg.Atlas, meshset: Callable[[meshes.Mesh], Any]
) -> None:
    direct = meshset(TUBE)
    direct.compute_segmentation_dcharts_per_face()
    direct.compute_texcoord_parametrization_charts_per_wedge()
    uv = direct.current_mesh().wedge_tex_coord_matrix().reshape(-1, 3, 2)
    assert (uv == atlas.uv).all()


def test_charts_are_flattened_as_they_are_given() -> None:
    labels = (TUBE[0][TUBE[1]].mean(axis=1)[:, 0] > 0).astype(np.uint8)
    halves = devseg.unwrap(*TUBE, charts=labels)
    groups = {tuple(sorted(set(labels[halves.chart_id == k]))) for k in set(halves.chart_id)}
    assert groups == {(0,), (1,)}
    own = devseg.segment(*TUBE, charts_number=3)
    assert (devseg.unwrap(*TUBE, charts=own).chart_id == own.chart_id).all()


def test_more_effort_packs_the_same_charts_more_densely() -> None:
    charts = devseg.segment(*BALL, charts_number=8)
    packed = {
        effort: devseg.unwrap(*BALL, charts=charts, effort=effort) for effort in ("fast", "best")
    }
    density = {effort: one.measures["packing_efficiency"] for effort, one in packed.items()}
    assert density["best"] > density["fast"] > 0.2
    with pytest.raises(devseg.DevsegError, match="effort: expected"):
        devseg.unwrap(*BALL, effort="most")


def test_a_cut_mesh_has_one_coordinate_for_each_vertex(atlas: devseg.Atlas) -> None:
    cut = atlas.cut()
    assert (cut.uv[cut.faces] == atlas.uv).all()
    assert (cut.origin[cut.faces] == atlas.faces).all()
    assert (cut.vertices == atlas.vertices[cut.origin]).all()
    assert len(cut.vertices) > len(atlas.vertices)


def test_deformed_charts_unfold_exactly() -> None:
    charts = devseg.segment(*BALL, "papercraft", charts_number=8)
    flat = devseg.deform(charts)
    assert flat.measures["residual"] < 1e-6 < flat.measures["initial_residual"]
    moved = np.linalg.norm(flat.vertices - BALL[0], axis=1)
    assert 0 < moved.max() < 0.5
    atlas = devseg.unwrap(flat.vertices, flat.faces, charts=flat)
    assert atlas.measures["l2_stretch"] == pytest.approx(1, abs=1e-6)


def test_a_sewn_preview_is_near_its_model(atlas: devseg.Atlas) -> None:
    seen = devseg.sewn_preview(atlas, stuffing=0.01)
    assert seen.faces.shape[1] == 3 and len(seen.distance) == len(seen.faces)
    assert 0 < seen.measures["mean_distance_share"] < 0.1
    assert np.abs(seen.vertices).max() < 2 * np.abs(TUBE[0]).max()


@pytest.mark.parametrize("kind", ["svg", "pdf", "dxf"])
def test_patterns_are_saved_true_to_scale(kind: str, atlas: devseg.Atlas, tmp_path: Path) -> None:
    pattern = devseg.pattern(atlas, height_mm=300, preset="sewing", seam_allowance_mm=6)
    assert isinstance(pattern.save(tmp_path / "deep" / f"toy.{kind}"), tuple)
    assert (tmp_path / "deep" / f"toy.{kind}").stat().st_size > 1000
    assert [p.name for p in (tmp_path / "deep").iterdir()] == [f"toy.{kind}"]


def test_sizes_and_the_axis_that_is_up_shape_a_pattern(atlas: devseg.Atlas) -> None:
    surface = areas(atlas.uv).sum()
    assert surface > 0
    extents = np.ptp(TUBE[0], axis=0)
    mm2 = {}
    for word, value in (("longest_mm", 300), ("height_mm", 300), ("mm_per_unit", 100)):
        mm2[word] = devseg.pattern(atlas, **{word: value}).measures()["area_mm2"]
    upright = devseg.pattern(atlas, height_mm=300, up="z").measures()["area_mm2"]
    assert mm2["longest_mm"] == pytest.approx((300 / extents.max() / 100) ** 2 * mm2["mm_per_unit"])
    assert mm2["height_mm"] == pytest.approx((300 / extents[1] / 100) ** 2 * mm2["mm_per_unit"])
    assert upright == pytest.approx((300 / extents[2] / 100) ** 2 * mm2["mm_per_unit"])


def test_pieces_are_flat_and_in_millimetres(atlas: devseg.Atlas) -> None:
    pattern = devseg.pattern(atlas, mm_per_unit=100)
    pieces = pattern.pieces()
    assert (pieces.vertices[:, 2] == 0).all()
    assert set(pieces.piece_id) == set(range(pattern.measures()["pieces_number"]))
    total = areas(pieces.vertices[pieces.faces][:, :, :2]).sum()
    assert total == pytest.approx(pattern.measures()["area_mm2"], rel=0.01)


REFUSED: dict[str, tuple[Callable[[], Any], str]] = {
    "flat": (lambda: devseg.segment([[0, 0], [1, 0]], [[0, 1, 0]]), "#V by 3 .* found 2 by 2"),
    "quads": (lambda: devseg.segment(BALL[0], [[0, 1, 2, 3]]), "#F by 3 .* found 1 by 4"),
    "reals": (lambda: devseg.segment(BALL[0], [[0.5, 1, 2]]), "expected whole numbers"),
    "none": (lambda: devseg.segment(BALL[0], np.zeros((0, 3), int)), "at least one triangle"),
    "beyond": (lambda: devseg.segment(BALL[0], [[0, 1, 10**9]]), "indices from 0 to .*1000000000"),
    "below": (lambda: devseg.segment(BALL[0], [[0, 1, -1]]), "found -1"),
    "nan": (lambda: devseg.segment([[np.nan, 0, 0]] * 3, [[0, 1, 2]]), "finite .* in row 0"),
    "method": (lambda: devseg.segment(*BALL, "magic"), "expected one of dcharts, .*'magic'"),
    "option": (lambda: devseg.segment(*BALL, chart=3), "chart: expected one of charts_number"),
    "value": (
        lambda: devseg.segment(*BALL, charts_number=-1),
        "charts_number: expected .*found -1",
    ),
    "kind": (lambda: devseg.segment(*BALL, charts_number=None), "expected a number or a text"),
    "flatten": (lambda: devseg.unwrap(*BALL, flatten="iron"), "flatten: expected one of"),
    "labels": (lambda: devseg.unwrap(*BALL, charts=[1, 2]), "charts: expected an array of"),
    "both": (lambda: devseg.unwrap(*BALL, charts=BALL[1][:, 0], beta=1), "beta: expected no opt"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_wrong_is_told(name: str) -> None:
    call, message = REFUSED[name]
    with pytest.raises(devseg.DevsegError, match=message):
        call()


def test_wrong_patterns_are_told_and_leave_no_file(atlas: devseg.Atlas, tmp_path: Path) -> None:
    for words, message in (
        ({"preset": "cooking"}, "preset: expected one of plain"),
        ({"height": 3}, "height: expected one of mm_per_unit"),
        ({"up": "x"}, "up: expected y or z"),
        ({"longest_mm": 0}, "longest_mm: expected a length above 0"),
        ({"longest_mm": 3, "height_mm": 3}, "expected one size"),
    ):
        with pytest.raises(devseg.DevsegError, match=message):
            devseg.pattern(atlas, **words)
    with pytest.raises(devseg.DevsegError, match=r"ends in one of \.svg, \.pdf, \.dxf"):
        devseg.pattern(atlas).save(tmp_path / "toy.jpg")
    with pytest.raises(devseg.DevsegError, match="fold_angle: expected a number from 0 to 180"):
        devseg.pattern(atlas, fold_angle=500).save(tmp_path / "new" / "toy.svg")
    assert not list(tmp_path.iterdir())


def test_progress_rises_and_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    seen: list[float] = []

    def progress(share: float, what: str) -> None:
        seen.append(share)
        print(f"{what}!")
        os.write(1, b"by hand!")

    devseg.unwrap(*BALL, progress=progress)
    assert len(seen) > 5 and seen == sorted(seen) and seen[0] >= 0 and 0.9 < seen[-1] <= 1
    printed = capfd.readouterr().out
    assert "packing charts!" in printed and "LOG" not in printed
    assert printed.count("by hand!") == len(seen)


def test_false_cancels_and_the_next_call_is_as_ever() -> None:
    calls: list[str] = []

    def stop(_: float, what: str) -> bool:
        calls.append(what)
        return len(calls) < 3

    with pytest.raises(devseg.Cancelled, match="cancelled"):
        devseg.unwrap(*BALL, progress=stop)
    assert len(calls) == 3
    assert devseg.segment(*meshes.cube()).charts_number >= 1


def test_an_error_of_the_progress_function_comes_through() -> None:
    def fail(share: float, _: str) -> float:
        return 1 / (share - share)

    with pytest.raises(ZeroDivisionError):
        devseg.segment(*BALL, progress=fail)


def test_observers_end_with_their_block(meshset: Callable[[meshes.Mesh], Any]) -> None:
    seen: list[float] = []
    direct = meshset(TUBE)
    with observed(Observation(lambda share, _: seen.append(share))):
        direct.compute_segmentation_dcharts_per_face()
    count = len(seen)
    direct.compute_segmentation_dcharts_per_face()
    assert 0 < count == len(seen)


def test_threads_wait_for_each_other() -> None:
    found: list[int] = []
    threads = [
        threading.Thread(target=lambda: found.append(devseg.segment(*TUBE).charts_number))
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3 and len(set(found)) == 1


def test_trimesh_there_and_back(atlas: devseg.Atlas) -> None:
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(2)
    vertices, faces = devseg.from_trimesh(ball)
    made = devseg.to_trimesh(devseg.unwrap(vertices, faces))
    assert made.visual.uv.shape == (len(made.vertices), 2) and len(made.faces) == len(ball.faces)
    assert (ball.vertices[made.vertex_attributes["origin"]] == made.vertices).all()
    charts = devseg.to_trimesh(devseg.segment(vertices, faces))
    assert charts.face_attributes["chart_id"].shape == (len(faces),)
    with pytest.raises(devseg.DevsegError, match=r"expected a trimesh.Trimesh, found Scene"):
        devseg.from_trimesh(trimesh.Scene())


def test_without_trimesh_it_is_named(atlas: devseg.Atlas, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(devseg.DevsegError, match="pip install trimesh"):
        devseg.to_trimesh(atlas)


def test_pyvista_finds_the_accessor() -> None:
    pyvista = pytest.importorskip("pyvista")
    tube = pyvista.Cylinder(resolution=40)
    made = tube.devseg.unwrap(charts_number=3)
    assert made.active_texture_coordinates.shape == (made.n_points, 2)
    assert made.cell_data["chart_id"].max() >= 0 and made.n_cells == tube.triangulate().n_cells
    assert tube.devseg.segment().cell_data["chart_id"].shape == (made.n_cells,)
    with pytest.raises(devseg.DevsegError, match="a mesh with faces"):
        pyvista.PolyData([[0.0, 0, 0]]).devseg.segment()


def test_importing_does_no_work_and_names_are_functions(pymeshlab: ModuleType) -> None:
    code = (
        "import sys, devseg, devseg.cli\n"
        "assert not {'numpy', 'pymeshlab', 'trimesh'} & set(sys.modules)\n"
        "assert all(callable(getattr(devseg, n)) for n in ('pattern', 'segment', 'unwrap'))\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": f"{ROOT}/scripts"})
    assert host.pymeshlab() is pymeshlab and devseg.__version__
    with pytest.raises(AttributeError, match="no attribute 'unwarp'"):
        devseg.unwarp  # noqa: B018
    assert set(devseg.__all__) <= set(dir(devseg))
    assert all(getattr(devseg, name) is not None for name in devseg.__all__)


def test_users_scripts_are_checked_by_the_types_of_the_package(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "import numpy as np\n"
        "import devseg\n"
        "atlas: devseg.Atlas = devseg.unwrap(np.eye(3), [[0, 1, 2]], progress=lambda s, w: s < 1)\n"
        "saved: tuple[str, ...] = devseg.pattern(atlas, height_mm=9).save('a.pdf')\n"
        "devseg.unwarp(atlas)\n"
        "devseg.pattern(3)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path / "cache", script],
        env={**os.environ, "MYPYPATH": f"{ROOT}/scripts"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    told = [line for line in done.stdout.splitlines() if line.startswith("script.py")]
    assert [line.split(":")[1] for line in told] == ["5", "6"], done.stdout


def test_warnings_come_after_a_failure_of_the_hosts_own() -> None:
    """The host prints no log any more then, whatever MeshSet is used in the process."""
    code = """
import numpy as np, devseg, pymeshlab
corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0.5, 0.5, 1], [0.5, 0.5, -1]])
fins = corners, np.array([[0, 1, 2], [1, 3, 2], [1, 2, 4], [2, 1, 5]])
devseg.load_plugins()
meshes = pymeshlab.MeshSet()
meshes.add_mesh(pymeshlab.Mesh(*fins))
try:
    meshes.compute_segmentation_dcharts_per_face(charts_number=-1)
except pymeshlab.PyMeshLabException:
    print(*devseg.segment(*fins, charts_number=1).warnings, sep="\\n")
"""
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.endswith("1 edge has more than two faces and was cut\n")
