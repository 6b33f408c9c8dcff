"""What a glTF file says of itself, looked at before the host reads it.

The host's reader believes every number of the file: it takes strips and lines for triangles, reads
beyond buffers and follows nodes for ever. Of what is wrong with a file it tells nothing.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from devseg.errors import DevsegError

EXTENSIONS = (".gltf", ".glb")

_MODES = {
    0: "points",
    1: "lines",
    2: "a line loop",
    3: "a line strip",
    5: "a triangle strip",
    6: "a triangle fan",
}
_TRIANGLES = 4
# Bytes and numpy type of the component types.
_COMPONENTS = {
    5120: (1, "i1"),
    5121: (1, "u1"),
    5122: (2, "<i2"),
    5123: (2, "<u2"),
    5125: (4, "<u4"),
    5126: (4, "<f4"),
}
_PARTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
# Extensions without which the mesh itself cannot be read.
_COMPRESSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")

_GLB = b"glTF"
_JSON_CHUNK, _BIN_CHUNK = 0x4E4F534A, 0x004E4942


class _Fault(Exception):
    """What is wrong with a file, in words that follow its name."""


def check(path: Path) -> None:
    """Refuses a file that is not in order, or that holds no triangles.

    Raises:
        DevsegError: with the first fault that was found.
    """
    try:
        scene, binary = read(path.read_bytes())
        _Checker(path, scene, binary).check()
    except _Fault as fault:
        raise DevsegError(f"{path}: {fault}; export it again") from fault
    except (TypeError, AttributeError, KeyError, ValueError, IndexError, OverflowError) as error:
        # JSON of another structure than glTF has.
        raise DevsegError(
            f"{path}: expected JSON as glTF 2.0 defines it, a part of it is of another kind "
            f"({error}); export it again"
        ) from error


def read(data: bytes) -> tuple[dict[str, Any], bytes | None]:
    """The JSON of a .gltf or .glb file, and the binary part of a .glb file."""
    if data[:4] != _GLB:
        return _json(data), None
    if len(data) < 12:
        raise _Fault(f"the header of a GLB file has 12 bytes, found {len(data)}")
    _, version, size = struct.unpack("<4sII", data[:12])
    if version != 2:
        raise _Fault(f"expected GLB version 2, found {version}")
    if size > len(data):
        raise _Fault(f"expected {size} bytes, found {len(data)}: the file is cut off")
    scene, binary, at = None, None, 12
    while at + 8 <= size:
        length, kind = struct.unpack("<II", data[at : at + 8])
        chunk = data[at + 8 : at + 8 + length]
        if len(chunk) < length:
            raise _Fault(f"a part of {length} bytes has only {len(chunk)}: the file is cut off")
        if kind == _JSON_CHUNK and scene is None:
            scene = _json(chunk)
        elif kind == _BIN_CHUNK and binary is None:
            binary = chunk
        at += 8 + length
    if scene is None:
        raise _Fault("expected a JSON part in the GLB file, found none")
    return scene, binary


def _json(text: bytes) -> dict[str, Any]:
    try:
        scene = json.loads(text.decode("utf-8-sig"))
    except ValueError as error:
        raise _Fault(f"expected JSON, found an error in it ({error})") from error
    except RecursionError as error:
        raise _Fault("the JSON is nested without end") from error
    if not isinstance(scene, dict):
        raise _Fault("expected a JSON object")
    return scene


@dataclass(frozen=True)
class Object:
    """A node that has a mesh.

    Attributes:
        name: of the node, or of its mesh.
        materials: names of the materials of its primitives and their numbers of triangles.
    """

    name: str
    materials: list[tuple[str, int]]


def objects(path: Path) -> list[Object]:
    """The objects of a file, as the host goes through them. The file must be in order."""
    scene, _ = read(path.read_bytes())
    names = _material_names(scene)
    found: list[Object] = []
    stack = list(reversed(scene["scenes"][scene.get("scene", 0)].get("nodes", [])))
    while stack:
        node = scene["nodes"][stack.pop()]
        if "mesh" in node:
            mesh = scene["meshes"][node["mesh"]]
            materials = [
                (names[p["material"]] if "material" in p else "", _triangles(scene, p))
                for p in mesh["primitives"]
            ]
            name = node.get("name") or mesh.get("name") or f"object {len(found)}"
            found.append(Object(name, materials))
        stack += reversed(node.get("children", []))
    return found


def material_colors(path: Path) -> dict[str, tuple[float, float, float]]:
    """Red, green and blue of each material by its name; the file must be in order."""
    scene, _ = read(path.read_bytes())
    colors = {}
    for name, material in zip(_material_names(scene), scene.get("materials", []), strict=True):
        factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", [1.0, 1.0, 1.0])
        red, green, blue = map(float, factor[:3])
        colors[name] = (red, green, blue)
    return colors


def _material_names(scene: dict[str, Any]) -> list[str]:
    materials = scene.get("materials", [])
    return [str(m.get("name") or f"material {i}") for i, m in enumerate(materials)]


def _triangles(scene: dict[str, Any], primitive: dict[str, Any]) -> int:
    index = primitive.get("indices", primitive["attributes"]["POSITION"])
    return scene["accessors"][index]["count"] // 3


class _Checker:
    """Follows the references of one file as the host does."""

    def __init__(self, path: Path, scene: dict[str, Any], binary: bytes | None) -> None:
        self.folder = path.parent
        self.scene = scene
        self.binary = binary
        self.buffers: dict[int, bytes] = {}

    def check(self) -> None:
        version = str(self.scene.get("asset", {}).get("version", "no version"))
        if version.split(".")[0] != "2":
            raise _Fault(f"expected glTF version 2, found {version}")
        for name in self.scene.get("extensionsRequired", []):
            if name in _COMPRESSIONS:
                raise _Fault(f"it is compressed with {name}, which the host cannot read")
        if not self.scene.get("meshes"):
            raise _Fault("expected meshes, found none")
        for number in sorted(self._meshes_in_scene()):
            mesh = self.scene["meshes"][number]
            name = f"mesh {mesh.get('name', number)!r}"
            for primitive in mesh["primitives"]:
                self._check_primitive(name, primitive)

    def _item(self, kind: str, index: Any, owner: str) -> Any:
        items = self.scene.get(kind, [])
        if type(index) is not int or not 0 <= index < len(items):
            raise _Fault(f"{owner} names {kind}[{index}], the file has {len(items)}")
        return items[index]

    def _meshes_in_scene(self) -> set[int]:
        """The meshes that the nodes of the scene name, once each."""
        scenes = self.scene.get("scenes", [])
        if not scenes:
            raise _Fault("expected a scene, found none")
        chosen = self.scene.get("scene", 0)
        roots = self._item("scenes", chosen, "the file").get("nodes", [])
        # Depth first, without recursion: (node, whether its children are done).
        above: set[int] = set()
        seen: set[int] = set()
        meshes: set[int] = set()
        stack = [(node, False, f"scene {chosen}") for node in reversed(roots)]
        while stack:
            index, done, owner = stack.pop()
            if done:
                above.discard(index)
                continue
            node = self._item("nodes", index, owner)
            if index in seen:
                how = "is its own descendant" if index in above else "has two parents"
                raise _Fault(f"node {index} {how}")
            seen.add(index)
            above.add(index)
            if "mesh" in node:
                self._item("meshes", node["mesh"], f"node {index}")
                meshes.add(node["mesh"])
            for key, length in (("matrix", 16), ("translation", 3), ("rotation", 4), ("scale", 3)):
                if key in node and not _are_numbers(node[key], length):
                    raise _Fault(f"{key} of node {index}: expected {length} numbers")
            stack.append((index, True, owner))
            children = node.get("children", [])
            stack += [(child, False, f"node {index}") for child in reversed(children)]
        if not meshes:
            raise _Fault("expected a mesh in the scene, found none")
        return meshes

    def _check_primitive(self, name: str, primitive: dict[str, Any]) -> None:
        mode = primitive.get("mode", _TRIANGLES)
        if mode != _TRIANGLES:
            raise _Fault(
                f"{name} is {_MODES.get(mode, 'unknown')} (mode {mode}), not triangles (4)"
            )
        if any(extension in _COMPRESSIONS for extension in primitive.get("extensions", {})):
            raise _Fault(f"{name} is compressed, which the host cannot read")
        if "material" in primitive:
            self._item("materials", primitive["material"], name)
        attributes = primitive.get("attributes", {})
        if "POSITION" not in attributes:
            raise _Fault(f"{name} has no positions")
        vertices = 0
        for attribute, accessor in attributes.items():
            count = self._check_accessor(accessor, f"{attribute} of {name}")
            if attribute == "POSITION":
                vertices = count
                kind = self._item("accessors", accessor, name)
                if (kind["type"], kind["componentType"]) != ("VEC3", 5126):
                    raise _Fault(f"positions of {name}: expected three 32 bit numbers each")
            elif count < vertices:
                raise _Fault(f"{attribute} of {name}: expected {vertices} values, found {count}")
        if "indices" in primitive:
            self._check_indices(primitive["indices"], name, vertices)

    def _check_indices(self, index: Any, name: str, vertices: int) -> None:
        import numpy as np

        count = self._check_accessor(index, f"indices of {name}")
        accessor = self._item("accessors", index, name)
        if accessor["componentType"] not in (5121, 5123, 5125) or accessor["type"] != "SCALAR":
            raise _Fault(f"indices of {name}: expected whole numbers")
        if count % 3:
            raise _Fault(f"indices of {name}: expected three for each triangle, found {count}")
        start, step = self._place(accessor)
        size, kind = _COMPONENTS[accessor["componentType"]]
        data = self._buffer(self.scene["bufferViews"][accessor["bufferView"]]["buffer"])
        if step != size:
            raise _Fault(f"indices of {name} are not packed")
        largest = int(np.frombuffer(data, kind, count, start).max(initial=0))
        if largest >= vertices:
            raise _Fault(f"a triangle of {name} names vertex {largest}, there are {vertices}")

    def _check_accessor(self, index: Any, owner: str) -> int:
        """Looks whether all values lie in the buffer; returns their number."""
        accessor = self._item("accessors", index, owner)
        if "sparse" in accessor or "bufferView" not in accessor:
            raise _Fault(f"{owner} are sparse, which the host cannot read")
        kind, component, count = accessor["type"], accessor["componentType"], accessor["count"]
        if kind not in _PARTS or component not in _COMPONENTS or type(count) is not int:
            raise _Fault(f"{owner}: unknown type {kind} of {component}")
        view = self._item("bufferViews", accessor["bufferView"], owner)
        self._item("buffers", view["buffer"], owner)
        start, step = self._place(accessor)
        size = _PARTS[kind] * _COMPONENTS[component][0]
        end = start + step * (count - 1) + size if count > 0 else start
        in_view = view.get("byteOffset", 0) + view["byteLength"]
        length = len(self._buffer(view["buffer"]))
        if start < 0 or count < 0 or not size <= step <= 252 or end > min(in_view, length):
            raise _Fault(f"{owner}: {count} values end at byte {end} of {min(in_view, length)}")
        return count

    def _place(self, accessor: dict[str, Any]) -> tuple[int, int]:
        """Where the first value starts in its buffer, and how far the next one is."""
        view = self.scene["bufferViews"][accessor["bufferView"]]
        size = _PARTS[accessor["type"]] * _COMPONENTS[accessor["componentType"]][0]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return start, view.get("byteStride") or size

    def _buffer(self, index: int) -> bytes:
        if index not in self.buffers:
            buffer = self.scene["buffers"][index]
            data = self._load(index, buffer)
            if len(data) < buffer["byteLength"]:
                raise _Fault(
                    f"buffer {index}: expected {buffer['byteLength']} bytes, found {len(data)}"
                )
            self.buffers[index] = data
        return self.buffers[index]

    def _load(self, index: int, buffer: dict[str, Any]) -> bytes:
        uri = buffer.get("uri")
        if uri is None:
            if self.binary is None:
                raise _Fault(f"buffer {index} names no file, and the file has no binary part")
            return self.binary
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2])
            except binascii.Error as error:
                raise _Fault(f"buffer {index} is no base64 text ({error})") from error
        file = self.folder / unquote(uri)
        if not file.is_file():
            raise _Fault(f"its buffer {unquote(uri)} is missing; keep both files in one folder")
        return file.read_bytes()


def _are_numbers(values: Any, count: int) -> bool:
    return len(values) == count and all(isinstance(value, int | float) for value in values)
