"""What of a result survives saving and loading: docs/hosts.md promises it."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import devseg
import meshes


@pytest.fixture
def flattened(meshset: Callable[[meshes.Mesh], Any]) -> Any:
    ms = meshset(meshes.sphere())
    ms.compute_segmentation_dcharts_per_face(charts_number=6)
    ms.compute_texcoord_parametrization_charts_per_wedge()
    return ms


def test_ply_keeps_attributes_colors_and_texture_coordinates(
    flattened: Any, tmp_path: Path
) -> None:
    file = tmp_path / "result.ply"
    before = flattened.current_mesh()
    flattened.save_current_mesh(str(file), __ca_fs__chart_id=True, __ca_fs__seam_edges=True)
    segmentation = flattened.get_segmentation_measures()
    flattened.load_new_mesh(str(file))
    after = flattened.current_mesh()
    # The host writes custom attributes, but does not read them.
    assert devseg.restore_attributes(after, file) == ["chart_id", "seam_edges"]
    for read in (
        lambda m: m.face_custom_scalar_attribute_array("chart_id"),
        lambda m: m.face_custom_scalar_attribute_array("seam_edges"),
        lambda m: m.face_color_matrix(),
        lambda m: m.wedge_tex_coord_matrix(),
        lambda m: m.face_scalar_array(),
    ):
        np.testing.assert_array_equal(read(after), read(before))
    assert flattened.get_segmentation_measures() == segmentation


def test_obj_keeps_texture_coordinates(flattened: Any, tmp_path: Path) -> None:
    file = tmp_path / "result.obj"
    before = flattened.current_mesh().wedge_tex_coord_matrix()
    charts = flattened.get_parametrization_measures()["charts_number"]
    flattened.save_current_mesh(str(file), save_wedge_texcoord=True)
    flattened.load_new_mesh(str(file))
    after = flattened.current_mesh()
    np.testing.assert_allclose(after.wedge_tex_coord_matrix(), before, rtol=0, atol=1e-6)
    # Charts and cuts are read off the texture coordinates.
    assert flattened.get_segmentation_measures()["charts_number"] == charts


def write_gltf(file: Path, vertices: np.ndarray, uv: np.ndarray, faces: np.ndarray) -> Path:
    """A glTF file with texture coordinates at the vertices."""
    parts = [vertices.astype("<f4"), uv.astype("<f4"), faces.astype("<u4").ravel()]
    data = b"".join(part.tobytes() for part in parts)
    views, offset = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": part.nbytes})
        offset += part.nbytes
    low, high = vertices.min(axis=0).tolist(), vertices.max(axis=0).tolist()
    count = len(vertices)
    real, index = 5126, 5125
    accessors = [
        {"componentType": real, "count": count, "type": "VEC3", "min": low, "max": high},
        {"componentType": real, "count": count, "type": "VEC2"},
        {"componentType": index, "count": faces.size, "type": "SCALAR"},
    ]
    attributes = {"POSITION": 0, "TEXCOORD_0": 1}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2}]}],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
        "bufferViews": views,
        "accessors": [{**a, "bufferView": i} for i, a in enumerate(accessors)],
    }
    file.write_text(json.dumps(document))
    return file


def test_gltf_is_read_with_texture_coordinates_and_not_written(
    pymeshlab: ModuleType, flattened: Any, tmp_path: Path
) -> None:
    corners = flattened.current_mesh().wedge_tex_coord_matrix()
    mesh = flattened.current_mesh()
    charts = flattened.get_parametrization_measures()["charts_number"]
    vertices = mesh.vertex_matrix()[mesh.face_matrix().ravel()]
    # glTF counts v from the top of the image.
    uv = np.stack([corners[:, 0], 1 - corners[:, 1]], axis=1)
    faces = np.arange(len(vertices)).reshape(-1, 3)
    file = write_gltf(tmp_path / "result.gltf", vertices, uv, faces)
    flattened.load_new_mesh(str(file))
    loaded = flattened.current_mesh()
    np.testing.assert_allclose(loaded.wedge_tex_coord_matrix(), corners, rtol=0, atol=1e-6)
    flattened.meshing_merge_close_vertices()
    assert flattened.get_parametrization_measures()["charts_number"] == charts
    flattened.save_current_mesh(str(tmp_path / "pattern.svg"))
    assert (tmp_path / "pattern.svg").read_text().count("<path") >= charts
    with pytest.raises(pymeshlab.PyMeshLabException, match="Unknown format"):
        flattened.save_current_mesh(str(tmp_path / "again.gltf"))
