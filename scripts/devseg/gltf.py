"""What a glTF file says of itself, looked at before the host reads it.

The host's reader believes every number of the file: it takes strips and lines for triangles, reads
beyond buffers and follows nodes for ever. Of what is wrong with a file it tells nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from devseg.errors import DevsegError
from devseg.gltf_document import (
    COMPONENTS,
    MODES,
    PARTS,
    TRIANGLES,
    Document,
    Fault,
    has_triangles,
    read,
    sparse_parts,
)

EXTENSIONS = (".gltf", ".glb")

# Extensions without which the mesh itself cannot be read.
_COMPRESSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")


def check(path: Path) -> None:
    """Refuses a file that is not in order, or that holds no triangles.

    Raises:
        DevsegError: with the first fault that was found.
    """
    try:
        _Checker.of(path).check()
    except Fault as fault:
        raise DevsegError(f"{path}: {fault}; export it again") from fault
    except (TypeError, AttributeError, KeyError, ValueError, IndexError, OverflowError) as error:
        # JSON of another structure than glTF has.
        raise DevsegError(
            f"{path}: expected JSON as glTF 2.0 defines it, a part of it is of another kind "
            f"({error}); export it again"
        ) from error


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
    document = Document.of(path)
    names = _material_names(document.scene)
    found: list[Object] = []
    for node in document.nodes():
        if not any(map(has_triangles, document.primitives(node))):
            continue
        mesh = document.scene["meshes"][node["mesh"]]
        materials = [
            (names[p["material"]] if "material" in p else "", len(document.triangles(p)))
            for p in document.primitives(node)
            if has_triangles(p)
        ]
        name = node.get("name") or mesh.get("name") or f"object {len(found)}"
        found.append(Object(name, materials))
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


class _Checker(Document):
    """Follows the references of one file as the host does."""

    def check(self) -> None:
        version = str(self.scene.get("asset", {}).get("version", "no version"))
        if version.split(".")[0] != "2":
            raise Fault(f"expected glTF version 2, found {version}")
        for name in self.scene.get("extensionsRequired", []):
            if name in _COMPRESSIONS:
                raise Fault(f"it is compressed with {name}, which the host cannot read")
        if not self.scene.get("meshes"):
            raise Fault("expected meshes, found none")
        others: set[str] = set()
        found = False
        for number in sorted(self._meshes_in_scene()):
            mesh = self.scene["meshes"][number]
            name = f"mesh {mesh.get('name', number)!r}"
            for primitive in mesh["primitives"]:
                if has_triangles(primitive):
                    self._check_primitive(name, primitive)
                    found = True
                elif (mode := primitive["mode"]) in MODES:
                    others.add(MODES[mode])
                else:
                    raise Fault(f"{name} is of mode {mode}, which glTF does not know")
        if not found:
            what = " and ".join(sorted(others)) or "nothing"
            raise Fault(f"expected triangles, found {what}")

    def _item(self, kind: str, index: Any, owner: str) -> Any:
        items = self.scene.get(kind, [])
        if type(index) is not int or not 0 <= index < len(items):
            raise Fault(f"{owner} names {kind}[{index}], the file has {len(items)}")
        return items[index]

    def _meshes_in_scene(self) -> set[int]:
        """The meshes that the nodes of the scene name, once each."""
        scenes = self.scene.get("scenes", [])
        if not scenes:
            raise Fault("expected a scene, found none")
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
                raise Fault(f"node {index} {how}")
            seen.add(index)
            above.add(index)
            if "mesh" in node:
                self._item("meshes", node["mesh"], f"node {index}")
                meshes.add(node["mesh"])
            for key, length in (("matrix", 16), ("translation", 3), ("rotation", 4), ("scale", 3)):
                if key in node and not _are_numbers(node[key], length):
                    raise Fault(f"{key} of node {index}: expected {length} numbers")
            stack.append((index, True, owner))
            children = node.get("children", [])
            stack += [(child, False, f"node {index}") for child in reversed(children)]
        if not meshes:
            raise Fault("expected a mesh in the scene, found none")
        return meshes

    def _check_primitive(self, name: str, primitive: dict[str, Any]) -> None:
        if any(extension in _COMPRESSIONS for extension in primitive.get("extensions", {})):
            raise Fault(f"{name} is compressed, which the host cannot read")
        if "material" in primitive:
            self._item("materials", primitive["material"], name)
        attributes = primitive.get("attributes", {})
        if "POSITION" not in attributes:
            raise Fault(f"{name} has no positions")
        vertices = 0
        for attribute, accessor in attributes.items():
            count = self._check_accessor(accessor, f"{attribute} of {name}")
            if attribute == "POSITION":
                vertices = count
                kind = self._item("accessors", accessor, name)
                if kind["type"] != "VEC3":
                    raise Fault(f"positions of {name}: expected three numbers each")
            elif count < vertices:
                raise Fault(f"{attribute} of {name}: expected {vertices} values, found {count}")
        corners = vertices
        if "indices" in primitive:
            corners = self._check_indices(primitive["indices"], name, vertices)
        if primitive.get("mode", TRIANGLES) == TRIANGLES and corners % 3:
            raise Fault(f"{name}: expected three corners for each triangle, found {corners}")

    def _check_indices(self, index: Any, name: str, vertices: int) -> int:
        count = self._check_accessor(index, f"indices of {name}")
        accessor = self._item("accessors", index, name)
        if accessor["componentType"] not in (5121, 5123, 5125) or accessor["type"] != "SCALAR":
            raise Fault(f"indices of {name}: expected whole numbers")
        largest = int(self.indices(index).max(initial=0))
        if largest >= vertices:
            raise Fault(f"a triangle of {name} names vertex {largest}, there are {vertices}")
        return count

    def _check_accessor(self, index: Any, owner: str) -> int:
        """Looks whether all values lie in the buffer; returns their number."""
        accessor = self._item("accessors", index, owner)
        if "bufferView" in accessor:
            self._check_place(accessor, owner)
        if "sparse" in accessor:
            rows, values = sparse_parts(accessor)
            self._check_place(rows, owner)
            self._check_place(values, owner)
            if int(self.rows(rows).max(initial=0)) >= accessor["count"]:
                raise Fault(f"{owner}: sparse values beyond the {accessor['count']} that there are")
        return accessor["count"]

    def _check_place(self, accessor: dict[str, Any], owner: str) -> None:
        kind, component, count = accessor["type"], accessor["componentType"], accessor["count"]
        if kind not in PARTS or component not in COMPONENTS or type(count) is not int:
            raise Fault(f"{owner}: unknown type {kind} of {component}")
        view = self._item("bufferViews", accessor["bufferView"], owner)
        self._item("buffers", view["buffer"], owner)
        start, step = self.place(accessor)
        size = PARTS[kind] * COMPONENTS[component][0]
        end = start + step * (count - 1) + size if count > 0 else start
        in_view = view.get("byteOffset", 0) + view["byteLength"]
        length = len(self.buffer(view["buffer"]))
        if start < 0 or count < 0 or not size <= step <= 252 or end > min(in_view, length):
            raise Fault(f"{owner}: {count} values end at byte {end} of {min(in_view, length)}")


def _are_numbers(values: Any, count: int) -> bool:
    return len(values) == count and all(isinstance(value, int | float) for value in values)
