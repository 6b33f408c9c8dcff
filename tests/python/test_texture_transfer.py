"""A textured mesh keeps its look in a new layout."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from PIL import Image

import meshes
from devseg import host

SIZE = 256


def waves() -> np.ndarray:
    y, x, k = np.meshgrid(np.arange(SIZE), np.arange(SIZE), np.arange(3), indexing="ij")
    return np.round(127 + 100 * np.sin(0.05 * (k + 1) * x + k) * np.cos(0.04 * y + k)).astype("u1")


@pytest.fixture
def textured(tmp_path: Path, pymeshlab: ModuleType) -> Any:
    """A ball whose texture goes around it once."""
    vertices, faces = meshes.sphere()
    Image.fromarray(waves()).save(tmp_path / "waves.png")
    (tmp_path / "ball.mtl").write_text("newmtl skin\nmap_Kd waves.png\n")
    rows = ["mtllib ball.mtl"] + ["v {:.17g} {:.17g} {:.17g}".format(*v) for v in vertices]
    corners, words = [], ["usemtl skin"]
    for face in faces:
        turn = np.arctan2(vertices[face, 2], vertices[face, 0]) / (2 * np.pi) + 0.5
        turn = np.where(turn < turn.max() - 0.5, turn + 1, turn)
        for u, v in zip(turn, 0.5 + 0.45 * vertices[face, 1], strict=True):
            corners.append(f"vt {u:.9g} {v:.9g}")
        last = len(corners)
        words.append("f " + " ".join(f"{v + 1}/{last - 2 + k}" for k, v in enumerate(face)))
    (tmp_path / "ball.obj").write_text("\n".join([*rows, *corners, *words]) + "\n")
    meshset = pymeshlab.MeshSet()
    _alive.append(meshset)
    meshset.load_new_mesh(str(tmp_path / "ball.obj"))
    return meshset


_alive: list[Any] = []


def refuse(meshset: Any, pymeshlab: ModuleType) -> None:
    meshset.set_verbosity(True)  # a silent host goes on swallowing what is printed after a failure
    with host.captured(), pytest.raises(pymeshlab.PyMeshLabException, match="run that first"):
        meshset.transfer_texture_to_new_layout()
    meshset.set_verbosity(False)


def sampled(image: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Bilinear, v up, repeated."""
    height, width = image.shape[:2]
    x, y = uv[:, 0] * width - 0.5, (1 - uv[:, 1]) * height - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = (x - left)[:, None], (y - top)[:, None]

    def pixel(dx: int, dy: int) -> np.ndarray:
        return image[(top + dy) % height, (left + dx) % width].astype(float)

    upper = (1 - a) * pixel(0, 0) + a * pixel(1, 0)
    return (1 - b) * upper + b * ((1 - a) * pixel(0, 1) + a * pixel(1, 1))


def test_colours_are_the_same_at_a_thousand_places(
    textured: Any, tmp_path: Path, pymeshlab: ModuleType
) -> None:
    mesh = textured.current_mesh()
    old = mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    textured.compute_segmentation_dcharts_per_face(charts_number=4)
    textured.compute_texcoord_parametrization_charts_per_wedge()
    textured.apply_texcoord_chart_packing_per_wedge()  # the first coordinates count
    made = textured.transfer_texture_to_new_layout(texture_size=512)
    assert made["textures_number"] == 1 and 0.4 < made["filled_share"] <= 1
    mesh = textured.current_mesh()
    new = mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    (tmp_path / "out").mkdir()
    textured.save_current_mesh(str(tmp_path / "out" / "ball.obj"))
    files = list((tmp_path / "out").glob("*.png"))
    assert len(files) == 1
    baked = np.asarray(Image.open(files[0]).convert("RGB"))
    assert baked.shape == (512, 512, 3)

    random = np.random.default_rng(1)
    face = random.integers(len(old), size=1000)
    weights = random.dirichlet((1, 1, 1), size=1000)[:, :, None]
    before = sampled(waves(), (weights * old[face]).sum(axis=1))
    after = sampled(baked, (weights * new[face]).sum(axis=1))
    assert np.abs(before - after).mean() <= 2
    refuse(textured, pymeshlab)  # the new coordinates fit their image


def test_says_what_is_missing(textured: Any, pymeshlab: ModuleType) -> None:
    refuse(textured, pymeshlab)
