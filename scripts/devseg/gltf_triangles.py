"""glTF files of strips, fans, sparse or whole numbers, rewritten: the host reads none of them."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote, unquote

from devseg.gltf_document import MODES, TRIANGLES, Document, has_triangles

if TYPE_CHECKING:
    import numpy as np

# What the host makes use of.
_ATTRIBUTES = ("POSITION", "TEXCOORD_0", "COLOR_0")
_FLOAT, _UNSIGNED = 5126, 5125
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


def rewritten(path: Path, folder: Path) -> tuple[Path, list[str]]:
    """A file that holds the same as plain triangles, for the host to read.

    Args:
        path: a file that is in order.
        folder: where to write it, with its buffers.

    Returns:
        The file, `path` itself where the host can read it; and notes on what was left out.
    """
    document = Document.of(path)
    primitives = [p for node in document.nodes() for p in document.primitives(node)]
    if all(_is_plain(document.scene, p) for p in primitives):
        return path, []
    left_out = {MODES[p["mode"]] for p in primitives if not has_triangles(p)}
    notes = [f"{' and '.join(sorted(left_out))} of the file were left out"] if left_out else []
    return _Writer(document, path.parent, folder).write(path.stem), notes


def _is_plain(scene: dict[str, Any], primitive: dict[str, Any]) -> bool:
    if primitive.get("mode", TRIANGLES) != TRIANGLES:
        return False
    position = primitive["attributes"]["POSITION"]
    used = [*primitive["attributes"].values(), primitive.get("indices", position)]
    accessors = [scene["accessors"][i] for i in used]
    position = scene["accessors"][position]
    return position["componentType"] == _FLOAT and not any(
        "sparse" in one or "bufferView" not in one for one in accessors
    )


class _Writer:
    """Writes a document anew, with one buffer that holds all that the host makes use of."""

    def __init__(self, document: Document, source: Path, folder: Path) -> None:
        self.document = document
        self.source = source
        self.folder = folder
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []

    def write(self, name: str) -> Path:
        """NAME.gltf and its buffer."""
        scene = self.document.scene
        meshes: dict[int, dict[str, Any]] = {}
        for node in self.document.nodes():
            if node["mesh"] not in meshes:
                meshes[node["mesh"]] = self._mesh(scene["meshes"][node["mesh"]])
        order = [index for index, mesh in meshes.items() if mesh["primitives"]]
        kept = {"asset", "scene", "scenes", "materials", "textures", "samplers"}
        result = {key: value for key, value in scene.items() if key in kept}
        result["nodes"] = [_node(node, order) for node in scene["nodes"]]
        result["meshes"] = [meshes[index] for index in order]
        result["images"] = [self._image(image) for image in scene.get("images", [])]
        buffer = f"{name}.bin"
        result["buffers"] = [{"uri": quote(buffer), "byteLength": len(self.data)}]
        result["bufferViews"], result["accessors"] = self.views, self.accessors
        (self.folder / buffer).write_bytes(self.data)
        path = self.folder / f"{name}.gltf"
        path.write_text(json.dumps(result), encoding="utf-8")
        return path

    def _mesh(self, mesh: dict[str, Any]) -> dict[str, Any]:
        primitives = [self._primitive(p) for p in mesh["primitives"] if has_triangles(p)]
        return {**{k: v for k, v in mesh.items() if k == "name"}, "primitives": primitives}

    def _primitive(self, primitive: dict[str, Any]) -> dict[str, Any]:
        import numpy as np

        used = {k: v for k, v in primitive["attributes"].items() if k in _ATTRIBUTES}
        faces = self.document.triangles(primitive)
        return {
            **({"material": primitive["material"]} if "material" in primitive else {}),
            "attributes": {k: self._add(self.document.floats(v), _FLOAT) for k, v in used.items()},
            "indices": self._add(faces.reshape(-1, 1).astype(np.uint32), _UNSIGNED),
            "mode": TRIANGLES,
        }

    def _add(self, values: np.ndarray, component: int) -> int:
        """The accessor of values, #V by their numbers each."""
        data = values.tobytes()
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        self.data += data
        self.views.append(view)
        accessor = {"bufferView": len(self.views) - 1, "componentType": component}
        count, parts = values.shape
        self.accessors.append({**accessor, "type": _TYPES[parts], "count": count})
        return len(self.accessors) - 1

    def _image(self, image: dict[str, Any]) -> dict[str, Any]:
        """Where an image lies, seen from the new file; none for one that lay in a buffer."""
        uri = image.get("uri", "")
        if not uri or uri.startswith("data:"):
            return {"uri": "none"}
        return {"uri": quote(os.path.relpath(self.source / unquote(uri), self.folder))}


def _node(node: dict[str, Any], meshes: list[int]) -> dict[str, Any]:
    """The node, with the new number of its mesh."""
    result = {key: value for key, value in node.items() if key not in ("mesh", "skin", "camera")}
    if node.get("mesh") in meshes:
        result["mesh"] = meshes.index(node["mesh"])
    return result
