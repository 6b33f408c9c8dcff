"""Textures and colours are printed on the pieces, where they belong."""

from __future__ import annotations

import base64
import io
import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from lxml import etree
from PIL import Image

import meshes
from devseg.cli import main
from test_texture_transfer import sampled

SIZE = 128
DPI = 300
# Names are drawn on faces: few of so many places.
PRINTED = 0.9

_alive: list[Any] = []


def picture(seed: int) -> np.ndarray:
    y, x, k = np.meshgrid(np.arange(SIZE), np.arange(SIZE), np.arange(3), indexing="ij")
    waves = np.sin(0.06 * (k + 1) * x + seed + k) * np.cos(0.05 * y + k * seed)
    return np.round(127 + 100 * waves).astype("u1")


@pytest.fixture
def two_textures(tmp_path: Path) -> Path:
    """A tube, which unfolds exactly, whose lower half shows another image than the upper one."""
    vertices, faces = meshes.cylinder()
    places = 0.5 + 0.3 * vertices[:, ::2] + 0.05 * vertices[:, 1:2]
    materials, words, corners = [], [], []
    for i in range(2):
        Image.fromarray(picture(i)).save(tmp_path / f"image{i}.png")
        materials += [f"newmtl skin{i}", f"map_Kd image{i}.png"]
    (tmp_path / "tube.mtl").write_text("\n".join(materials) + "\n")
    upper = vertices[faces].mean(axis=1)[:, 1] > np.median(vertices[:, 1])
    for i in range(2):
        words.append(f"usemtl skin{i}")
        for face in faces[upper == bool(i)]:
            corners += ["vt {:.9g} {:.9g}".format(*places[v]) for v in face]
            last = len(corners)
            words.append("f " + " ".join(f"{v + 1}/{last - 2 + k}" for k, v in enumerate(face)))
    rows = ["mtllib tube.mtl"] + ["v {:.17g} {:.17g} {:.17g}".format(*v) for v in vertices]
    path = tmp_path / "tube.obj"
    path.write_text("\n".join([*rows, *corners, *words]) + "\n")
    return path


def paper_places(mesh: Any, mm_per_unit: float) -> np.ndarray:
    """Where the corners of the faces lie on a single sheet, in mm from its lower left corner."""
    points, faces = mesh.vertex_matrix(), mesh.face_matrix()
    uv = mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    corners = points[faces]
    sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(*sides), axis=1).sum()
    (a, b), (c, d) = (uv[:, 1] - uv[:, 0]).T, (uv[:, 2] - uv[:, 0]).T
    scale = np.sqrt(area / np.abs(a * d - b * c).sum()) * mm_per_unit
    return scale * (uv - uv.reshape(-1, 2).min(axis=0)) + 10.0


def read_places(image: np.ndarray, places: np.ndarray) -> np.ndarray:
    pixels = places * DPI / 25.4
    return image[len(image) - 1 - pixels[:, 1].astype(int), pixels[:, 0].astype(int)].astype(float)


def export(meshset: Any, file: Path, **parameters: Any) -> np.ndarray:
    plain = {"labels": False, "frame": False, "scale_check": False, "simplify_mm": 0.0}
    meshset.apply_filter(
        "export_pattern", output_file=str(file), **{**plain, "texture": "Automatic", **parameters}
    )
    if file.suffix != ".png":
        return np.zeros(0)
    with Image.open(file) as opened:
        assert opened.info["dpi"] == pytest.approx((DPI, DPI), abs=0.5)
        return np.asarray(opened.convert("RGB"))


def test_pages_show_the_textures_at_a_thousand_places(
    two_textures: Path, tmp_path: Path, pymeshlab: ModuleType
) -> None:
    meshset = pymeshlab.MeshSet()
    _alive.append(meshset)
    meshset.load_new_mesh(str(two_textures))
    mesh = meshset.current_mesh()
    old = mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    height = mesh.vertex_matrix()[:, 1]
    upper = height[mesh.face_matrix()].mean(axis=1) > np.median(height)
    meshset.compute_segmentation_dcharts_per_face(charts_number=6)
    meshset.compute_texcoord_parametrization_charts_per_wedge()
    page = export(meshset, tmp_path / "tube.png", bleed_mm=0.0, mm_per_unit=30.0)

    places = paper_places(meshset.current_mesh(), 30.0)
    random = np.random.default_rng(1)
    face = random.integers(len(old), size=1000)
    weights = random.dirichlet((4, 4, 4), size=1000)[:, :, None]
    printed = read_places(page, (weights * places[face]).sum(axis=1))
    uv = (weights * old[face]).sum(axis=1)
    wanted = np.where(upper[face][:, None], sampled(picture(1), uv), sampled(picture(0), uv))
    errors = np.abs(printed - wanted).max(axis=1)
    assert (errors <= 8).mean() >= PRINTED  # others lie below the cut lines
    assert np.median(errors) <= 3

    # The same picture in a PDF, drawn by another program, and in an SVG.
    export(meshset, tmp_path / "tube.pdf", bleed_mm=0.0, mm_per_unit=30.0, cover=False)
    subprocess.run(
        ["pdftoppm", "-r", str(DPI), "-png", "-singlefile", "tube.pdf", "drawn"],
        cwd=tmp_path,
        check=True,
    )
    with Image.open(tmp_path / "drawn.png") as opened:
        drawn = np.asarray(opened.convert("RGB"))
    assert abs(len(drawn) - len(page)) <= 1
    again = read_places(drawn, (weights * places[face]).sum(axis=1))
    assert np.median(np.abs(again - wanted).max(axis=1)) <= 6
    assert (np.abs(again - wanted).max(axis=1) <= 16).mean() >= PRINTED


@pytest.mark.parametrize("kind", ["f_color_matrix", "v_color_matrix"])
def test_colours_of_the_model_survive_those_of_its_charts(
    kind: str, tmp_path: Path, pymeshlab: ModuleType
) -> None:
    vertices, faces = meshes.sphere()
    count = len(faces) if kind[0] == "f" else len(vertices)
    color = np.tile([0.2, 0.6, 0.8, 1.0], (count, 1))
    meshset = pymeshlab.MeshSet()
    _alive.append(meshset)
    meshset.add_mesh(pymeshlab.Mesh(vertices, faces, **{kind: color}))
    meshset.compute_segmentation_dcharts_per_face(charts_number=4)
    meshset.compute_color_by_chart_per_face()
    meshset.compute_texcoord_parametrization_charts_per_wedge()
    page = export(meshset, tmp_path / "tube.png", mm_per_unit=30.0)
    # Pieces are laid out anew for the bleed: nearly all that is printed has the one colour.
    printed = page[(page != 255).any(axis=2)]
    assert (np.abs(printed.astype(int) - [51, 153, 204]).max(axis=1) <= 2).mean() > PRINTED
    share = (np.abs(page.astype(int) - [51, 153, 204]).max(axis=2) <= 2).sum()
    without = export(meshset, tmp_path / "none.png", mm_per_unit=30.0, bleed_mm=0.0)
    own = (np.abs(without.astype(int) - [51, 153, 204]).max(axis=2) <= 2).sum()
    assert share > own > 0.2 * without.shape[0] * without.shape[1]


def test_svg_keeps_the_picture_off_the_cut_layer(
    two_textures: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    options = ["--method", "papercraft", "--charts", "6", "--texture", "auto", "--bleed", "1.5"]
    paper = ["--page", "a4", "--height-mm", "80", "--registration-marks"]
    formats = ["--formats", "svg,pdf,png,dxf"]
    assert main(["run", str(two_textures), "-o", str(out), *options, *paper, *formats]) == 0
    printed = capfd.readouterr().out
    root = etree.parse(str(out / "tube.svg")).getroot()
    name = {"svg": "http://www.w3.org/2000/svg", "x": "http://www.w3.org/1999/xlink"}
    layers = [g.get("id") for g in root.findall("svg:g", name)]
    assert layers[0] == "texture" and {"cut", "registration"} <= set(layers)
    images = root.findall(".//svg:image", name)
    assert images == root.findall("svg:g[@id='texture']/svg:image", name)
    clips = {c.get("id") for c in root.iter("{http://www.w3.org/2000/svg}clipPath")}
    for image in images:
        assert re.fullmatch(r"url\(#(.*)\)", image.get("clip-path"))[1] in clips
        data = image.get("{http://www.w3.org/1999/xlink}href").split(",", 1)[1]
        with Image.open(io.BytesIO(base64.b64decode(data))) as opened:
            assert opened.width / float(image.get("width")) == pytest.approx(DPI / 25.4, rel=0.01)
    assert len(images) == len(root.findall("svg:g[@id='cut']/svg:path", name))
    pages = sorted(p.name for p in out.glob("tube_page*.png"))
    written = json.loads((out / "tube.json").read_text())["outputs"]
    assert pages and pages == sorted(n for k, n in written.items() if k.startswith("page"))
    assert "pattern" in printed and pages[0] in printed


def test_says_that_there_are_no_colours(
    obj: Callable, tmp_path: Path, fails: Callable[..., str]
) -> None:
    path = obj(meshes.sphere(), "plain.obj")
    message = fails("run", path, "-o", tmp_path / "out", "--texture", "auto")
    assert "--texture" in message and not (tmp_path / "out").exists()
