"""Reading what the host does not read of a PLY file, and refusing what it cannot survive."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import meshes
from devseg import DevsegError, ply, restore_attributes
from devseg.load import load_mesh


def header(vertices: int, faces: int, form: str = "binary_little_endian") -> bytes:
    return (
        f"ply\nformat {form} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {faces}\nproperty list uchar int vertex_indices\n"
        "end_header\n"
    ).encode()


def test_attributes_survive_saving_and_loading(meshset: Callable, tmp_path: Path) -> None:
    saved = meshset(meshes.cylinder())
    count = saved.current_mesh().face_number()
    charts, seams = np.arange(count) % 5.0, np.arange(count) % 8.0
    saved.current_mesh().add_face_custom_scalar_attribute(charts, "chart_id")
    saved.current_mesh().add_face_custom_scalar_attribute(seams, "seam_edges")
    path = tmp_path / "saved.ply"
    saved.save_current_mesh(str(path), __ca_fs__chart_id=True, __ca_fs__seam_edges=True)

    loaded = load_mesh(path).meshes
    mesh = loaded.current_mesh()
    assert restore_attributes(mesh, path) == ["chart_id", "seam_edges"]
    np.testing.assert_array_equal(mesh.face_custom_scalar_attribute_array("chart_id"), charts)
    np.testing.assert_array_equal(mesh.face_custom_scalar_attribute_array("seam_edges"), seams)


def test_file_without_attributes_restores_none(meshset: Callable, tmp_path: Path) -> None:
    saved = meshset(meshes.cube())
    path = tmp_path / "plain.ply"
    saved.save_current_mesh(str(path))
    assert restore_attributes(saved.current_mesh(), path) == []


@pytest.mark.parametrize("form", ["binary_little_endian", "ascii"])
def test_header_that_promises_too_much_is_refused(tmp_path: Path, form: str) -> None:
    path = tmp_path / "huge.ply"
    path.write_bytes(header(2_000_000_000, 1, form) + b"\0" * 64)
    with pytest.raises(DevsegError, match="2000000000 x vertex"):
        ply.check_size(path)


def test_complete_file_is_accepted(tmp_path: Path) -> None:
    path = tmp_path / "triangle.ply"
    path.write_bytes(header(3, 1) + b"\0" * 36 + b"\3" + b"\0" * 12)
    ply.check_size(path)
    path.write_bytes(path.read_bytes()[: len(header(3, 1)) + 20])
    with pytest.raises(DevsegError, match="cut off"):
        ply.check_size(path)
