"""`devseg compare`: a table, a picture and a JSON file for several methods."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import meshes
from devseg.cli import main


@pytest.fixture
def torus(tmp_path: Path) -> Path:
    u, v = np.meshgrid(np.arange(24), np.arange(12), indexing="ij")
    a, b = u * 2 * np.pi / 24, v * 2 * np.pi / 12
    points = np.stack([(2 + np.cos(b)) * np.cos(a), (2 + np.cos(b)) * np.sin(a), np.sin(b)], axis=2)

    def at(i: int, j: int) -> int:
        return (i % 24) * 12 + j % 12

    faces = []
    for i in range(24):
        for j in range(12):
            faces.append((at(i, j), at(i + 1, j), at(i + 1, j + 1)))
            faces.append((at(i, j), at(i + 1, j + 1), at(i, j + 1)))
    lines = [f"v {x} {y} {z}" for x, y, z in points.reshape(-1, 3)]
    lines += [f"f {x + 1} {y + 1} {z + 1}" for x, y, z in faces]
    path = tmp_path / "torus.obj"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_table_picture_and_json(
    torus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    methods = "t-flooding,vsa,mcgim"
    code = main(["compare", str(torus), "--methods", methods, "--charts", "6", "-o", str(out)])
    assert code == 0
    printed = capsys.readouterr().out.splitlines()
    assert printed[0].split() == ["t-flooding", "vsa", "mcgim"]
    charts = next(line for line in printed if line.startswith("charts"))
    assert charts.split()[1:] == ["6", "6", "6"]
    assert {file.name for file in out.iterdir()} == {"torus-compare.png", "torus-compare.json"}
    found = json.loads((out / "torus-compare.json").read_text())["methods"]
    deviation = {name: one["segmentation"]["gauss_area_std"] for name, one in found.items()}
    assert deviation["t-flooding"] < 0.4 * min(deviation["vsa"], deviation["mcgim"])
    for one in found.values():
        assert one["segmentation"]["disk_charts_number"] == 6
        assert one["circle"]["circle_l2_stretch"] >= 1
        assert one["parametrization"]["flipped_faces_number"] == 0
    with Image.open(out / "torus-compare.png") as image:
        assert image.width == 3 * 600


def test_unknown_methods_are_refused(torus: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as error:
        main(["compare", str(torus), "--methods", "vsa,best"])
    assert error.value.code == 2
    assert (
        "expected some of dcharts,t-flooding,plush,papercraft,vsa,mcgim, found 'best'"
        in capsys.readouterr().err
    )


def test_more_charts_than_faces_are_as_many_as_faces(
    torus: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ["-o", str(tmp_path / "out"), "--json"]
    assert main(["compare", str(torus), "--methods", "vsa", "--charts", "9999", *out]) == 0
    (one,) = json.loads(capsys.readouterr().out)["methods"].values()
    assert one["segmentation"]["charts_number"] == 576


def test_small_meshes_get_fewer_charts(
    obj: Callable, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = obj(meshes.cube()), tmp_path / "out"
    assert main(["compare", str(path), "--methods", "vsa,mcgim", "-o", str(out), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    for one in result["methods"].values():
        assert 6 <= one["segmentation"]["charts_number"] <= 12
