"""Materials, their certified strain, and markers, from the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import meshes
import pattern_files as files
from devseg.cli import main
from meshes import write_obj


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ball of radius 1."""
    path = tmp_path_factory.mktemp("cloth") / "ball.obj"
    write_obj(path, *meshes.sphere())
    return path


def _run(ball: Path, folder: Path, *options: str) -> dict[str, Any]:
    arguments = ["run", str(ball), "-o", str(folder), "--no-picture", "--height-mm", "200"]
    assert main([*arguments, *options]) == 0
    result: dict[str, Any] = json.loads((folder / "ball.json").read_text())
    return result


def test_strain_is_told_for_each_piece(ball: Path, tmp_path: Path) -> None:
    """Few charts of a method that knows no strain are too much for leather; a note says so."""
    options = ["--method", "vsa", "--charts", "4", "--material", "leather", "--formats", "svg"]
    result = _run(ball, tmp_path, *options)
    pieces = result["cloth"]["pieces"]
    assert len(pieces) == result["parametrization"]["charts_number"]
    assert result["cloth"]["pieces_above_limits"] > 0
    assert any("strain leather" in w or "strains leather" in w for w in result["warnings"])
    for piece in pieces.values():
        assert 0 <= piece["along_95"] <= piece["along"]
        assert piece["within_limits"] == (piece["limit_use"] <= 1 and piece["worst_use"] <= 2)


def test_charts_keep_the_limits_of_their_material(ball: Path, tmp_path: Path) -> None:
    """D-Charts are cut until the finished pieces strain the material within its limits."""
    options = ["--charts", "4", "--formats", "svg", "--preset", "sewing"]
    lengths = []
    for material, limit in (("fleece", 0.1), ("vinyl", 0.02)):
        result = _run(ball, tmp_path / material, *options, "--material", material)
        assert result["cloth"]["pieces_above_limits"] == 0
        assert result["method_results"]["strain_99"] <= limit
        assert result["method_results"]["largest_strain"] <= 2 * limit
        assert not any(f"strain {material}" in warning for warning in result["warnings"])
        lengths.append(result["method_results"]["seam_length"])
    assert lengths[0] < lengths[1]


def test_materials_have_pieces_and_strips_of_their_own(tmp_path: Path) -> None:
    """The upper half of a ball is red, the lower one blue: so is each piece, and each marker."""
    vertices, faces = meshes.sphere()
    up = vertices[faces].mean(axis=1)[:, 1] > 0
    path = tmp_path / "ball.obj"
    rows = ["v " + " ".join(f"{x:.9g}" for x in vertex) for vertex in vertices]
    for name, half in (("red felt", faces[up]), ("blue", faces[~up])):
        rows += [f"usemtl {name}", *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in half)]
    path.write_text("\n".join(rows))
    options = ["--material-borders", "materials", "--fabric-width-mm", "500", "--effort", "fast"]
    result = _run(path, tmp_path / "out", *options, "--formats", "svg,ply", "--charts", "4")
    count = result["parametrization"]["charts_number"]
    told = result["materials"]
    assert set(told) == {"blue", "red felt"}
    assert sum(len(one["pieces"]) for one in told.values()) == count
    areas = [one["area_mm2"] for one in told.values()]
    assert areas[0] == pytest.approx(areas[1], rel=0.05)
    assert sum(areas) == pytest.approx(result["needs"]["material_mm2"])
    strips = result["marker"]["strips"]
    assert set(strips) == set(told)
    assert sum(strip["length_mm"] for strip in strips.values()) == pytest.approx(
        result["marker"]["length_mm"]
    )
    text = (tmp_path / "out" / "ball_marker.svg").read_text()
    assert "red felt, 500 mm wide" in text
    assert "blue, 500 mm wide" in text
    # No piece has faces of both.
    assert not any("faces of other materials" in warning for warning in result["warnings"])


def test_borders_need_materials(
    ball: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A ball of one material has none, and nothing is written."""
    out = tmp_path / "out"
    for source in ("colors", "materials", "attribute"):
        arguments = ["run", str(ball), "-o", str(out), "--material-borders", source]
        assert main(arguments) == 1
        assert "expected faces of several materials" in capsys.readouterr().err
    assert not out.exists()


def test_values_of_its_own_come_from_a_file(ball: Path, tmp_path: Path) -> None:
    """A material that bears everything has no note."""
    file = tmp_path / "rubber.json"
    values = {"like": "leather", "warp": 2, "weft": 2, "bias": 2, "compression": 0.99}
    file.write_text(json.dumps(values))
    result = _run(ball, tmp_path / "out", "--charts", "4", "--material", str(file))
    assert result["cloth"]["pieces_above_limits"] == 0
    assert result["cloth"]["material"].startswith("leather, warp=2")


def test_marker_is_written_beside_the_pattern(ball: Path, tmp_path: Path) -> None:
    """Twice all pieces, within the cloth, without overlap; readable in all formats."""
    options = ["--fabric-width-mm", "600", "--selvedge", "20", "--copies", "2"]
    options += ["--effort", "fast", "--preset", "sewing", "--formats", "svg,pdf,dxf"]
    result = _run(ball, tmp_path, *options)
    marker = result["marker"]
    assert {f"marker_{kind}" for kind in ("svg", "pdf", "dxf")} <= set(result["outputs"])
    cut = files.read_svg(tmp_path / "ball_marker.svg")["cut"]
    polygons = files.polygons(cut)
    assert len(polygons) == 2 * len(files.polygons(files.read_svg(tmp_path / "ball.svg")["cut"]))
    assert files.largest_overlap(list(polygons.values())) < 1e-3
    low, high = (
        min(p.bounds[0] for p in polygons.values()),
        max(p.bounds[2] for p in polygons.values()),
    )
    assert high - low <= 560.01
    area = sum(p.area for p in polygons.values())
    assert marker["use"] == pytest.approx(area / (560 * marker["length_mm"]), rel=1e-3)
    assert files.read_pdf(tmp_path / "ball_marker.pdf")["Cut"].parts


def test_sizes_lie_over_each_other(ball: Path, tmp_path: Path) -> None:
    """Cut lines scale with the height, around the same places."""
    arguments = ["run", str(ball), "-o", str(tmp_path), "--no-picture", "--formats", "svg"]
    assert main([*arguments, "--sizes", "150,300,200"]) == 0
    layers = files.read_svg(tmp_path / "ball.svg")
    areas = {
        size: sum(p.area for p in files.polygons(layers[name]).values())
        for size, name in ((150, "size-150"), (200, "size-200"), (300, "cut"))
    }
    assert areas[150] == pytest.approx(areas[300] / 4, rel=0.01)
    assert areas[200] == pytest.approx(areas[300] * 4 / 9, rel=0.01)
    large = files.polygons(layers["cut"])
    for name, small in files.polygons(layers["size-150"]).items():
        piece = large[name.removesuffix("-150") + "-cut"]
        assert piece.intersection(small).area > 0.95 * small.area


def test_sizes_may_have_files_of_their_own(ball: Path, tmp_path: Path) -> None:
    """One file each, named by its height."""
    arguments = ["run", str(ball), "-o", str(tmp_path), "--no-picture", "--formats", "svg"]
    assert main([*arguments, "--sizes", "150,300", "--sizes-apart"]) == 0
    result = json.loads((tmp_path / "ball.json").read_text())
    assert result["outputs"] == {
        "svg_150": "ball_150.svg",
        "svg_300": "ball_300.svg",
        "json": "ball.json",
    }
    areas = [
        sum(p.area for p in files.polygons(files.read_svg(tmp_path / name)["cut"]).values())
        for name in ("ball_150.svg", "ball_300.svg")
    ]
    assert areas[1] == pytest.approx(4 * areas[0], rel=0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--material", "silk"], "expected one of cotton"),
        (["--material", "cotton, warp=-1"], "warp from 0 to 2"),
        (["--fabric-width-mm", "50"], "expected cloth that is as wide"),
        (["--fabric-width-mm", "900", "--fold", "--grain", "free"], "expected a grain"),
    ],
)
def test_what_does_not_fit_is_refused(
    ball: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], message: str
) -> None:
    """One error, and nothing is written."""
    out = tmp_path / "out"
    assert (
        main(["run", str(ball), "-o", str(out), "--no-picture", "--height-mm", "200", *options])
        == 1
    )
    assert message in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--fold"], "--fold needs the width of the cloth"),
        (["--fabric-width-mm", "900", "--formats", "ply"], "needs --formats"),
        (["--grain", "sideways"], "expected best"),
        (["--material-borders", "colors", "--keep-seams"], "charts that the method makes"),
        (["--sizes", "200,200"], "heights in mm that differ"),
        (["--sizes", "200", "--height-mm", "100"], "leave --height-mm"),
        (["--material", "nothing.json"], "cannot read nothing.json"),
    ],
)
def test_wrong_usage_is_told(
    ball: Path, capsys: pytest.CaptureFixture[str], options: list[str], message: str
) -> None:
    """Exit code 2, before anything is read."""
    with pytest.raises(SystemExit) as stopped:
        main(["run", str(ball), "-o", "out", *options])
    assert stopped.value.code == 2
    assert message in capsys.readouterr().err
