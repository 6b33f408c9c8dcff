"""glTF files that lie are refused with the reason, before the host reads them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import gltf_files
import meshes
from devseg import gltf
from devseg.errors import DevsegError
from devseg.load import load_mesh
from devseg.obj_parts import Part

Scene = dict[str, Any]


def primitive(scene: Scene) -> dict[str, Any]:
    return scene["meshes"][0]["primitives"][0]


def sparse(view: int, offset: int) -> dict[str, Any]:
    """One row of an accessor is replaced by vertex 1: that which stands at a place of a view."""
    at = {"bufferView": view, "byteOffset": offset, "componentType": gltf_files.UNSIGNED}
    return {"count": 1, "indices": at, "values": {"bufferView": 0, "byteOffset": 12}}


def changes() -> dict[str, tuple[Callable[[Scene], Any], str]]:
    """What is done to a file in order, and the reason that is expected."""
    modes = {0: "points", 1: "lines", 2: "line loop", 3: "line strip", 9: "mode 9"}
    cases = {
        words: ((lambda s, m=mode: primitive(s).update(mode=m)), words)
        for mode, words in modes.items()
    }
    return {
        **cases,
        "version 1": (lambda s: s["asset"].update(version="1.0"), "version 2, found 1.0"),
        "no scene": (lambda s: s.pop("scenes"), "expected a scene"),
        "wrong node": (lambda s: s["scenes"][0].update(nodes=[4]), r"names nodes\[4\]"),
        "recursive": (lambda s: s["nodes"][0].update(children=[0]), "its own descendant"),
        "wrong child": (lambda s: s["nodes"][0].update(children=[7]), r"node 0 names nodes\[7\]"),
        "wrong mesh": (lambda s: s["nodes"][0].update(mesh=7), r"names meshes\[7\], .* has 1"),
        "matrix": (lambda s: s["nodes"][0].update(matrix=[1, 2]), "expected 16 numbers"),
        "material": (lambda s: primitive(s).update(material=5), r"names materials\[5\]"),
        "accessor": (lambda s: primitive(s).update(indices=9), r"names accessors\[9\]"),
        "no positions": (lambda s: primitive(s).update(attributes={}), "has no positions"),
        "view": (lambda s: s["accessors"][1].update(bufferView=9), r"names bufferViews\[9\]"),
        "buffer": (lambda s: s["bufferViews"][0].update(buffer=3), r"names buffers\[3\]"),
        "count": (lambda s: s["accessors"][0].update(count=10**5), "end at byte 1200000 of 96"),
        "offset": (lambda s: s["bufferViews"][0].update(byteOffset=10**8), "end at byte"),
        "kind": (lambda s: s["accessors"][0].update(type="VEC2"), "expected three"),
        "component": (lambda s: s["accessors"][1].update(componentType=1), "unknown type"),
        "corners": (lambda s: s["accessors"][1].update(count=35), "three corners .* found 35"),
        "sparse": (lambda s: s["accessors"][0].update(sparse=sparse(0, 20)), "beyond the 8"),
        "length": (lambda s: s["buffers"][0].update(byteLength=999), "expected 999 bytes"),
        "missing": (lambda s: s["buffers"][0].update(uri="no.bin"), "buffer no.bin is missing"),
        "structure": (lambda s: s.update(nodes="none"), "as glTF 2.0 defines it"),
        "draco": (
            lambda s: s.update(extensionsRequired=["KHR_draco_mesh_compression"]),
            "compressed with KHR_draco",
        ),
    }


@pytest.mark.parametrize("name", changes())
def test_a_wrong_file_is_refused_with_the_reason(name: str, tmp_path: Path) -> None:
    scene, data = gltf_files.document(meshes.cube())
    gltf.check(gltf_files.write_gltf(tmp_path / "right.gltf", scene, data))
    scene["buffers"][0].pop("uri")
    change, reason = changes()[name]
    change(scene)
    path = gltf_files.write_gltf(tmp_path / "wrong.gltf", scene, data)
    with pytest.raises(DevsegError, match=reason):
        gltf.check(path)


def test_indices_must_name_vertices(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    path = gltf_files.write_glb(tmp_path / "a.glb", *gltf_files.document((vertices, faces + 5)))
    with pytest.raises(DevsegError, match="'mesh 0' names vertex 12, there are 8"):
        gltf.check(path)


@pytest.mark.parametrize("size", [3, 11, 40, -4])
def test_a_file_that_is_cut_off_is_refused(size: int, tmp_path: Path) -> None:
    path = gltf_files.write_glb(tmp_path / "a.glb", *gltf_files.document(meshes.cube()))
    gltf.check(path)
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(DevsegError, match=r"JSON|12 bytes|cut off"):
        gltf.check(path)


def test_the_command_line_tells_the_reason(tmp_path: Path, fails: Callable[..., str]) -> None:
    path = gltf_files.write_gltf(
        tmp_path / "lines.gltf", *gltf_files.document(meshes.cube(), mode=1)
    )
    error = fails("run", path, "-o", tmp_path / "out")
    assert "lines.gltf: expected triangles, found lines" in error
    assert not (tmp_path / "out").exists()


def loaded(path: Path) -> tuple[Any, Any, list[str]]:
    """Places of the corners of the faces, #F by 3 by 3; the file; and what was told."""
    found = load_mesh(path)
    mesh = found.meshes.current_mesh()
    return mesh.vertex_matrix()[mesh.face_matrix()], found, found.warnings


@pytest.mark.usefixtures("pymeshlab")
@pytest.mark.parametrize("indexed", [True, False])
@pytest.mark.parametrize(("mode", "faces"), [
    (5, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
    (6, [[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
])  # fmt: skip
def test_strips_and_fans_are_read(
    mode: int, faces: list[list[int]], indexed: bool, tmp_path: Path
) -> None:
    points = np.random.default_rng(1).random((5, 3)).astype("f4")
    # The double corner stitches two strips together: triangles without an area.
    row = [0, 1, 2, 3, 4, 4] if indexed else [0, 1, 2, 3, 4]
    scene, data = gltf_files.document((points, np.array(row)), mode=mode)
    scene["materials"] = [{"name": "felt"}]
    primitive(scene)["material"] = 0
    if not indexed:
        primitive(scene).pop("indices")
    path = gltf_files.write_gltf(tmp_path / "a.gltf", scene, data)
    corners, found, warnings = loaded(path)
    assert corners == pytest.approx(points[faces])
    assert warnings == []
    assert found.parts == [Part("object 0", "", "felt")]


@pytest.mark.usefixtures("pymeshlab")
def test_lines_beside_triangles_are_left_out_and_told(tmp_path: Path) -> None:
    scene, data = gltf_files.document(meshes.cube(), meshes.sphere())
    scene["meshes"][0]["primitives"].append({**primitive(scene), "mode": 3})
    scene["meshes"][1]["primitives"][0]["mode"] = 1
    corners, found, warnings = loaded(gltf_files.write_glb(tmp_path / "a.glb", scene, data))
    assert len(corners) == 12
    assert warnings == ["a line strip and lines of the file were left out"]
    assert [part.object for part in found.parts] == ["object 0"]


@pytest.mark.usefixtures("pymeshlab")
def test_whole_numbers_and_sparse_values_are_read(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    scene, data = gltf_files.document((vertices, faces))
    scene["accessors"][0]["sparse"] = sparse(1, 0)  # the first corner of all, vertex 0
    moved = vertices.copy()
    moved[faces[0, 0]] = vertices[1]
    corners, _, _ = loaded(gltf_files.write_glb(tmp_path / "a.glb", scene, data))
    assert len(corners) == 12 and corners == pytest.approx(moved[faces])

    scene, data = gltf_files.document((vertices, faces))
    rows = np.zeros((8, 4), "<i2")  # each begins at a multiple of four bytes
    rows[:, :3] = vertices * 32767
    scene["accessors"][0].update(bufferView=2, componentType=5122, normalized=True)
    scene["bufferViews"].append(
        {"buffer": 0, "byteOffset": len(data), "byteLength": rows.nbytes, "byteStride": 8}
    )
    data += rows.tobytes()
    scene["buffers"][0]["byteLength"] = len(data)
    corners, _, _ = loaded(gltf_files.write_glb(tmp_path / "b.glb", scene, data))
    assert corners == pytest.approx(vertices[faces])


@pytest.mark.usefixtures("pymeshlab")
def test_textures_of_a_rewritten_file_are_found(tmp_path: Path) -> None:
    """So that the warning about new texture coordinates names them."""
    scene, data = gltf_files.document(meshes.cube(), mode=5)
    uv = np.random.default_rng(1).random((8, 2)).astype("<f4")
    accessor = {"bufferView": 2, "componentType": gltf_files.FLOAT, "type": "VEC2", "count": 8}
    scene["accessors"].append(accessor)
    scene["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": uv.nbytes})
    data += uv.tobytes()
    scene["buffers"][0]["byteLength"] = len(data)
    primitive(scene)["attributes"]["TEXCOORD_0"] = 2
    primitive(scene)["material"] = 0
    scene["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    scene["textures"] = [{"source": 0}]
    scene["images"] = [{"uri": "wood%20grain.png"}]
    Image.new("RGB", (4, 4)).save(tmp_path / "wood grain.png")
    _, found, _ = loaded(gltf_files.write_glb(tmp_path / "a.glb", scene, data))
    mesh = found.meshes.current_mesh()
    assert mesh.has_wedge_tex_coord()
    assert [Path(name).name for name in mesh.textures()] == ["wood grain.png"]


def test_a_fault_beside_the_triangles_is_told_as_such(tmp_path: Path) -> None:
    scene, data = gltf_files.document(meshes.cube())
    primitive(scene)["material"] = 0
    scene["materials"] = [{"normalTexture": {"scale": "no number"}}]
    path = gltf_files.write_glb(tmp_path / "a.glb", scene, data)
    with pytest.raises(DevsegError, match="its triangles are in order, but not what is beside"):
        load_mesh(path)
