"""The order of assembly, and what a pattern needs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import meshes
from devseg import guide
from devseg.cli import main
from sewing import check_order, solids

SCALE = 60.0  # mm for a unit


def test_order_of_a_ball_to_sew(flattened: Any, tmp_path: Path) -> None:
    results = flattened.apply_filter(
        "export_pattern",
        output_file=str(tmp_path / "ball.svg"),
        preset="Sewing",
        mm_per_unit=SCALE,
        step_numbers=True,
    )
    order = guide.assembly(results)
    assert check_order(results, order) == [set(order["sections"])]
    (opening,) = order["openings"]
    assert 40 <= opening["to_mm"] - opening["from_mm"] <= 80
    seam = results["opening_seam"][0]
    assert order["steps"][-1]["seams"] == [int(seam)]
    # The mark and its name are on both sides, and steps stand behind the numbers.
    svg = (tmp_path / "ball.svg").read_text(encoding="utf-8")
    assert svg.count("-opening") == 2 and svg.count(">leave open<") == 2
    for label, step in enumerate(results["seam_step"], 1):
        assert svg.count(f">{label} ({int(step)})<") in (0, 2)
    assert svg.count(" (1)<") >= 2


def test_what_a_ball_needs(flattened: Any, tmp_path: Path) -> None:
    def needs(**parameters: Any) -> dict[str, Any]:
        path = str(tmp_path / "ball.svg")
        options = {"mm_per_unit": SCALE, **parameters}
        return guide.needs(flattened.apply_filter("export_pattern", output_file=path, **options))

    plain = needs()
    surface = 4 * np.pi * SCALE**2
    assert plain["material_mm2"] == pytest.approx(surface, rel=0.01)
    assert plain["stuffing_litres"] == pytest.approx(4 / 3 * np.pi * (SCALE / 100) ** 3, rel=0.02)
    assert plain["stuffing_g"] == pytest.approx(30 * plain["stuffing_litres"])
    assert plain["sewing_minutes"] == pytest.approx(plain["seams_mm"] / 100)
    assert plain["hems_mm"] == 0 and plain["paper_sheets_number"] == 0
    sewn = needs(preset="Sewing", page="a4", sewing_mm_per_minute=200.0, stuffing_g_per_litre=10.0)
    assert sewn["material_mm2"] > surface + 0.9 * 7 * 2 * sewn["seams_mm"]
    assert sewn["sewing_minutes"] == pytest.approx(sewn["seams_mm"] / 200)
    assert sewn["stuffing_g"] == pytest.approx(10 * sewn["stuffing_litres"])
    assert sewn["paper_sheets_number"] > 0
    folded = needs(preset="Papercraft")
    assert folded["stuffing_litres"] == 0 and folded["sewing_minutes"] == 0


def test_what_is_open_is_not_closed(meshset: Any, tmp_path: Path) -> None:
    ms = meshset(meshes.cylinder(radius=1.0, height=3.0))
    ms.compute_segmentation_variational_shape_approximation_per_face(charts_number=4)
    ms.compute_seams_charts_to_disks_per_edge()
    ms.compute_texcoord_parametrization_charts_per_wedge()
    path = str(tmp_path / "tube.svg")
    results = ms.apply_filter("export_pattern", output_file=path, mm_per_unit=SCALE)
    order = guide.assembly(results)
    assert not order["openings"] and not check_order(results, order)


def check_both_crafts(ms: Any, folder: Path) -> None:
    path = str(folder / "toy.svg")
    for preset in ("Sewing", "Papercraft"):
        results = ms.apply_filter("export_pattern", output_file=path, preset=preset, height_mm=300)
        order = guide.assembly(results)
        assert check_order(results, order) == [set(order["sections"])]
        openings = [opening["to_mm"] - opening["from_mm"] for opening in order["openings"]]
        assert len(openings) == (preset == "Sewing")
        assert all(40 <= length <= 80 for length in openings)


def test_order_of_a_cube(meshset: Any, tmp_path: Path) -> None:
    ms = meshset(meshes.cube())
    ms.compute_segmentation_variational_shape_approximation_per_face(charts_number=6)
    ms.compute_seams_charts_to_disks_per_edge()
    ms.compute_texcoord_parametrization_charts_per_wedge()
    check_both_crafts(ms, tmp_path)


def test_order_of_several_parts(meshset: Any, tmp_path: Path) -> None:
    """Two cubes and a tube: the solids are closed, each once, and the tube is done first."""
    tube = meshes.joined(meshes.cube(), meshes.cylinder(radius=1.0, height=3.0), (5.0, 0.0, 0.0))
    ms = meshset(meshes.joined(tube, meshes.cube(), (10.0, 0.0, 0.0)))
    assert solids(ms.current_mesh().vertex_matrix(), ms.current_mesh().face_matrix()) == (2, 3)
    ms.compute_segmentation_variational_shape_approximation_per_face(charts_number=14)
    ms.compute_seams_charts_to_disks_per_edge()
    ms.compute_texcoord_parametrization_charts_per_wedge()
    for preset in ("Sewing", "Papercraft"):
        path = str(tmp_path / "parts.svg")
        results = ms.apply_filter("export_pattern", output_file=path, preset=preset, height_mm=300)
        order = guide.assembly(results)
        assert len(check_order(results, order)) == 2
        assert len(order["openings"]) == (2 if preset == "Sewing" else 0)


@pytest.mark.parametrize("name", ["teddy_27648", "penguin_6720", "bunny_69451"])
def test_order_of_toys(name: str, pymeshlab: Any, data: Path, tmp_path: Path) -> None:
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(data / "public" / f"{name}.ply"))
    ms.compute_segmentation_dcharts_per_face()
    ms.compute_texcoord_parametrization_charts_per_wedge(pack=False)
    check_both_crafts(ms, tmp_path)


def test_a_teddy_takes_six_pages(data: Path, tmp_path: Path) -> None:
    teddy = str(data / "public" / "teddy_27648.ply")
    options = ["--preset", "sewing", "--page", "a4", "--height-mm", "300", "--no-picture"]
    assert main(["run", teddy, "-o", str(tmp_path), "--formats", "svg", *options]) == 0
    result = json.loads((tmp_path / "teddy_27648.json").read_text(encoding="utf-8"))
    assert 0 < result["needs"]["paper_sheets_number"] <= 6


# ---------------------------------------------------------------- the page


def test_command_line_writes_a_guide(obj: Callable, tmp_path: Path) -> None:
    out = tmp_path / "out"
    options = ["--formats", "html", "--preset", "sewing", "--height-mm", "200", "--no-picture"]
    assert main(["run", str(obj(meshes.cube(), "cube")), "-o", str(out), *options]) == 0
    assert (out / "cube.html").is_file()
    result = json.loads((out / "cube.json").read_text(encoding="utf-8"))
    assert result["outputs"]["html"] == "cube.html"
    assert result["assembly"]["steps"][-1]["kind"] == "close"
    assert result["needs"]["stuffing_litres"] == pytest.approx(8.0, rel=0.01)
