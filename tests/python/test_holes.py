"""Holes that lie flat: inner contours of a piece, without slits to its outline."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshes
from devseg.cli import main
from pattern_files import Layer, length_cut_twice, polygons, read_dxf, read_pdf, read_svg

METHODS = ["dcharts", "t-flooding", "vsa", "mcgim", "papercraft", "plush"]
FOUR_HOLES = ["#########", "#.#.#.#.#", "#########"]


def run(path: Path, out: Path, *options: str) -> dict[str, Any]:
    """The report of `devseg run`, which must succeed."""
    assert main(["run", str(path), "-o", str(out), "--mm-per-unit", "10", *options]) == 0
    return json.loads((out / f"{path.stem}.json").read_text())


def charts(method: str, number: int) -> list[str]:
    """Plush toys have as many patches as they need."""
    return [] if method == "plush" else ["--charts", str(number)]


def cut_layer(out: Path) -> Layer:
    (path,) = out.glob("*.svg")
    return read_svg(path)["cut"]


def holes(layer: Layer) -> list[int]:
    """Inner contours of each piece, ascending; all lines are closed, and none is cut twice."""
    assert layer.parts == layer.rings, "a slit"
    assert length_cut_twice(layer) < 0.1
    return sorted(len(piece.interiors) for piece in polygons(layer).values())


def expect_sound(report: dict[str, Any]) -> None:
    flat = report["parametrization"]
    assert flat["flipped_faces_number"] == flat["overlapping_faces_number"] == 0
    assert flat["disk_charts_number"] + flat["holed_charts_number"] == flat["charts_number"]


@pytest.mark.parametrize("method", METHODS)
def test_a_sheet_with_holes_is_one_outline_with_inner_contours(
    method: str, obj: Callable, tmp_path: Path
) -> None:
    path = obj(meshes.sheet(FOUR_HOLES), "sheet")
    report = run(path, tmp_path / "out", "--method", method, *charts(method, 1))
    expect_sound(report)
    assert report["parametrization"]["holed_charts_number"] == 1
    assert report["parametrization"]["l2_stretch"] == pytest.approx(1.0, abs=1e-6)
    layer = cut_layer(tmp_path / "out")
    assert holes(layer) == [4]
    (piece,) = polygons(layer).values()
    low_x, low_y, high_x, high_y = piece.bounds
    assert sorted([high_x - low_x, high_y - low_y]) == pytest.approx([30.0, 90.0], abs=0.01)
    assert piece.area == pytest.approx(9 * 3 * 100.0 - 4 * 100.0, abs=0.1)
    # Contours come before the outline.
    assert [round(ring.area) for ring in layer.rings] == [100, 100, 100, 100, 2700]


def test_the_sides_of_a_plate_keep_their_holes(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.slab(FOUR_HOLES, 0.5), "plate")
    report = run(path, tmp_path / "out")
    expect_sound(report)
    assert report["parametrization"]["l2_stretch"] == pytest.approx(1.0, abs=1e-6)
    # Both sides may hang together.
    assert sum(holes(cut_layer(tmp_path / "out"))) == 8


def test_a_cube_with_a_square_hole_through_it(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.slab(["###", "#.#", "###"], 3.0), "cube")
    report = run(path, tmp_path / "out")
    expect_sound(report)
    assert report["parametrization"]["l2_stretch"] == pytest.approx(1.0, abs=1e-6)
    layer = cut_layer(tmp_path / "out")
    assert sum(holes(layer)) == 2
    area = sum(piece.area for piece in polygons(layer).values())
    assert area == pytest.approx(100.0 * (2 * 8 + 12 * 3 + 4 * 3), abs=1.0)


def test_a_washer_is_two_rings_and_two_walls(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.washer(2.0, 5.0, 1.0), "washer")
    report = run(path, tmp_path / "out")
    expect_sound(report)
    # A wall may bend around a few corners of a ring, to save a seam.
    assert report["parametrization"]["l2_stretch"] == pytest.approx(1.0, abs=1e-3)
    assert sum(holes(cut_layer(tmp_path / "out"))) == 2


@pytest.mark.parametrize("method", METHODS)
def test_every_method_gives_sound_charts_of_a_plate(
    method: str, obj: Callable, tmp_path: Path
) -> None:
    path = obj(meshes.slab(["#####", "#.#.#", "#####"], 1.0), "plate")
    expect_sound(run(path, tmp_path / "out", "--method", method, *charts(method, 6)))


def test_own_texture_coordinates_keep_their_holes(meshset: Callable, tmp_path: Path) -> None:
    vertices, faces = meshes.sheet(FOUR_HOLES)
    corners = vertices[faces][:, :, :2].reshape(-1, 2)
    ms = meshset((vertices, faces))
    pymeshlab_mesh = type(ms.current_mesh())(
        vertex_matrix=vertices, face_matrix=faces, w_tex_coords_matrix=corners
    )
    ms.add_mesh(pymeshlab_mesh)
    measured = ms.get_parametrization_measures()
    assert (measured["disk_charts_number"], measured["holed_charts_number"]) == (0, 1)
    ms.apply_filter("export_pattern", output_file=str(tmp_path / "own.svg"), mm_per_unit=10.0)
    assert holes(read_svg(tmp_path / "own.svg")["cut"]) == [4]


def test_all_files_have_the_contours(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.sheet(FOUR_HOLES), "sheet")
    run(path, tmp_path / "out", "--charts", "1", "--formats", "svg,pdf,dxf", "--preset", "laser")
    for read, suffix in [(read_svg, "svg"), (read_pdf, "pdf"), (read_dxf, "dxf")]:
        layers = {
            name.lower(): layer for name, layer in read(tmp_path / f"out/sheet.{suffix}").items()
        }
        areas = sorted(ring.area for ring in layers["cut"].rings)
        assert areas[-5:] == pytest.approx([100, 100, 100, 100, 2700], rel=0.01), suffix


def test_allowances_lie_in_holes_only_at_seams(obj: Callable, tmp_path: Path) -> None:
    # The hole of a sheet is open; those of a plate are sewn to their walls.
    run(
        obj(meshes.sheet(["###", "#.#", "###"]), "open"),
        tmp_path / "open",
        "--charts",
        "1",
        "--seam-allowance-mm",
        "2",
    )
    (piece,) = polygons(cut_layer(tmp_path / "open")).values()
    assert [round(contour_area(c), 2) for c in piece.interiors] == [100.0]
    run(
        obj(meshes.slab(["###", "#.#", "###"], 3.0), "sewn"),
        tmp_path / "sewn",
        "--seam-allowance-mm",
        "2",
    )
    areas = [
        contour_area(contour)
        for piece in polygons(cut_layer(tmp_path / "sewn")).values()
        for contour in piece.interiors
    ]
    assert areas == pytest.approx([36.0, 36.0], abs=0.1)


def contour_area(contour: Any) -> float:
    x, y = np.array(contour.coords).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
