"""A glTF 2.0 document: its JSON, its buffers and the triangles in them."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import unquote

if TYPE_CHECKING:
    import numpy as np

MODES = {
    0: "points",
    1: "lines",
    2: "a line loop",
    3: "a line strip",
}
TRIANGLES, STRIP, FAN = 4, 5, 6
# Bytes and numpy type of the component types.
COMPONENTS = {
    5120: (1, "i1"),
    5121: (1, "u1"),
    5122: (2, "<i2"),
    5123: (2, "<u2"),
    5125: (4, "<u4"),
    5126: (4, "<f4"),
}
PARTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_GLB = b"glTF"
_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942


class Fault(Exception):
    """What is wrong with a file, in words that follow its name."""


def read(data: bytes) -> tuple[dict[str, Any], bytes | None]:
    """The JSON of a .gltf or .glb file, and the binary part of a .glb file."""
    if data[:4] != _GLB:
        return _json(data), None
    if len(data) < 12:
        raise Fault(f"the header of a GLB file has 12 bytes, found {len(data)}")
    _, version, size = struct.unpack("<4sII", data[:12])
    if version != 2:
        raise Fault(f"expected GLB version 2, found {version}")
    if size > len(data):
        raise Fault(f"expected {size} bytes, found {len(data)}: the file is cut off")
    scene, binary, at = None, None, 12
    while at + 8 <= size:
        length, kind = struct.unpack("<II", data[at : at + 8])
        chunk = data[at + 8 : at + 8 + length]
        if len(chunk) < length:
            raise Fault(f"a part of {length} bytes has only {len(chunk)}: the file is cut off")
        if kind == _JSON_CHUNK and scene is None:
            scene = _json(chunk)
        elif kind == _BIN_CHUNK and binary is None:
            binary = chunk
        at += 8 + length
    if scene is None:
        raise Fault("expected a JSON part in the GLB file, found none")
    return scene, binary


def _json(text: bytes) -> dict[str, Any]:
    try:
        scene = json.loads(text.decode("utf-8-sig"))
    except ValueError as error:
        raise Fault(f"expected JSON, found an error in it ({error})") from error
    except RecursionError as error:
        raise Fault("the JSON is nested without end") from error
    if not isinstance(scene, dict):
        raise Fault("expected a JSON object")
    return scene


def has_triangles(primitive: dict[str, Any]) -> bool:
    """Whether it is made of triangles, in whatever order."""
    return primitive.get("mode", TRIANGLES) in (TRIANGLES, STRIP, FAN)


def sparse_parts(accessor: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The rows that a sparse accessor replaces, and what by, both as accessors of their own."""
    sparse = accessor["sparse"]
    rows = {**sparse["indices"], "type": "SCALAR", "count": sparse["count"]}
    kept = {key: accessor[key] for key in ("type", "componentType")}
    return rows, {**sparse["values"], **kept, "count": sparse["count"]}


_D = TypeVar("_D", bound="Document")


class Document:
    """The JSON of a file, and its buffers as they are asked for."""

    def __init__(self, folder: Path, scene: dict[str, Any], binary: bytes | None) -> None:
        self.folder = folder
        self.scene = scene
        self.binary = binary
        self.buffers: dict[int, bytes] = {}

    @classmethod
    def of(cls: type[_D], path: Path) -> _D:
        """The document in a file."""
        return cls(path.parent, *read(path.read_bytes()))

    def nodes(self) -> Iterator[dict[str, Any]]:
        """The nodes of the scene that have a mesh, as the host goes through them."""
        scene = self.scene
        stack = list(reversed(scene["scenes"][scene.get("scene", 0)].get("nodes", [])))
        while stack:
            node = scene["nodes"][stack.pop()]
            if "mesh" in node:
                yield node
            stack += reversed(node.get("children", []))

    def primitives(self, node: dict[str, Any]) -> list[dict[str, Any]]:
        """What the mesh of a node is made of."""
        return self.scene["meshes"][node["mesh"]]["primitives"]

    def triangles(self, primitive: dict[str, Any]) -> np.ndarray:
        """#T by 3, vertices of the primitive; those that repeat a vertex are left out."""
        import numpy as np

        if "indices" in primitive:
            corners = self.indices(primitive["indices"]).astype(np.uint32)
        else:
            position = primitive["attributes"]["POSITION"]
            corners = np.arange(self.scene["accessors"][position]["count"], dtype=np.uint32)
        mode = primitive.get("mode", TRIANGLES)
        if mode == TRIANGLES:
            faces = corners[: len(corners) // 3 * 3].reshape(-1, 3)
        elif mode == STRIP:
            faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
            faces[1::2] = faces[1::2][:, [0, 2, 1]]  # every other one is turned
        else:
            first = np.full(max(len(corners) - 2, 0), corners[:1].max(initial=0))
            faces = np.stack([corners[1:-1], corners[2:], first], axis=1)
        a, b, c = faces.T
        return faces[(a != b) & (b != c) & (c != a)]

    def indices(self, index: int) -> np.ndarray:
        """The values of an accessor of whole numbers."""
        return self.values(index)[:, 0]

    def values(self, index: int) -> np.ndarray:
        """The values of an accessor, #V by its numbers each, of the type that the file has."""
        import numpy as np

        accessor = self.scene["accessors"][index]
        if "bufferView" in accessor:
            found = self.rows(accessor)
        else:
            kind = COMPONENTS[accessor["componentType"]][1]
            found = np.zeros((accessor["count"], PARTS[accessor["type"]]), kind)
        if "sparse" not in accessor:
            return found
        at, replaced = sparse_parts(accessor)
        found = found.copy()
        found[self.rows(at)[:, 0]] = self.rows(replaced)
        return found

    def floats(self, index: int) -> np.ndarray:
        """The values of an accessor as the numbers that they stand for, in 32 bits."""
        import numpy as np

        values = self.values(index)
        if not self.scene["accessors"][index].get("normalized"):
            return values.astype("<f4")
        return np.maximum(values / np.iinfo(values.dtype).max, -1.0).astype("<f4")

    def rows(self, accessor: dict[str, Any]) -> np.ndarray:
        """The values that an accessor has in its buffer, #V by its numbers each."""
        import numpy as np

        kind = np.dtype(COMPONENTS[accessor["componentType"]][1])
        start, step = self.place(accessor)
        data = self.buffer(self.scene["bufferViews"][accessor["bufferView"]]["buffer"])
        shape = accessor["count"], PARTS[accessor["type"]]
        return np.ndarray(shape, kind, data, start, strides=(step, kind.itemsize))

    def place(self, accessor: dict[str, Any]) -> tuple[int, int]:
        """Where the first value starts in its buffer, and how far the next one is."""
        view = self.scene["bufferViews"][accessor["bufferView"]]
        size = PARTS[accessor["type"]] * COMPONENTS[accessor["componentType"]][0]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return start, view.get("byteStride") or size

    def buffer(self, index: int) -> bytes:
        """The bytes of a buffer, which are as many as the document says."""
        if index not in self.buffers:
            buffer = self.scene["buffers"][index]
            data = self._load(index, buffer)
            if len(data) < buffer["byteLength"]:
                raise Fault(
                    f"buffer {index}: expected {buffer['byteLength']} bytes, found {len(data)}"
                )
            self.buffers[index] = data
        return self.buffers[index]

    def _load(self, index: int, buffer: dict[str, Any]) -> bytes:
        uri = buffer.get("uri")
        if uri is None:
            if self.binary is None:
                raise Fault(f"buffer {index} names no file, and the file has no binary part")
            return self.binary
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2])
            except binascii.Error as error:
                raise Fault(f"buffer {index} is no base64 text ({error})") from error
        file = self.folder / unquote(uri)
        if not file.is_file():
            raise Fault(f"its buffer {unquote(uri)} is missing; keep both files in one folder")
        return file.read_bytes()
