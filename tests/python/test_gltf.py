"""glTF files that lie are refused with the reason, before the host reads them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import gltf_files
import meshes
from devseg import gltf
from devseg.errors import DevsegError

Scene = dict[str, Any]


def primitive(scene: Scene) -> dict[str, Any]:
    return scene["meshes"][0]["primitives"][0]


def changes() -> dict[str, tuple[Callable[[Scene], Any], str]]:
    """What is done to a file in order, and the reason that is expected."""
    modes = {0: "points", 1: "lines", 2: "line loop", 3: "line strip"}
    modes |= {5: "triangle strip", 6: "triangle fan"}
    cases = {
        words: ((lambda s, m=mode: primitive(s).update(mode=m)), f"mesh 'mesh 0' is .*{words}")
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
        "sparse": (lambda s: s["accessors"][0].pop("bufferView"), "sparse"),
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
        tmp_path / "strip.gltf", *gltf_files.document(meshes.cube(), mode=5)
    )
    error = fails("run", path, "-o", tmp_path / "out")
    assert "strip.gltf: mesh 'mesh 0' is a triangle strip (mode 5), not triangles" in error
    assert not (tmp_path / "out").exists()
