"""The objects of a file: their names, and all of them as one mesh in one frame."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from devseg import collada, gltf, obj_parts, ply, stl, three_ds, threemf
from devseg.errors import DevsegError
from devseg.frame import UPRIGHT
from devseg.obj_parts import Part

# The face attribute that says which part of the file a face belongs to.
PART_ATTRIBUTE = "part_id"
# The same before the objects are joined.
_LAYER_ATTRIBUTE = "part_of_layer"
_SHOWN = 12  # names in an error
# A name in what `comments` writes.
_NAMED = re.compile(r"(object|group|material) (.*?)(?=, (?:group|material) |$)")


@dataclass(frozen=True)
class Layer:
    """A mesh of the host.

    Attributes:
        id: of the host.
        faces: their number.
        parts: its parts and their numbers of faces, in order.
        is_lost: whether the file has more names, for other faces than the host has made of it.
    """

    id: int
    faces: int
    parts: list[tuple[Part, int]]
    is_lost: bool = False

    @property
    def name(self) -> str:
        """That of its object."""
        return self.parts[0][0].object


def layers(path: Path, meshes: Any) -> list[Layer]:
    """The layers of a file with the names of their parts, as far as the file has names."""
    found = []
    for mesh in meshes:
        # The host calls a layer as the file where it knows no better.
        name = "" if mesh.label() == path.name else mesh.label()
        faces = mesh.face_number()
        found.append(Layer(mesh.id(), faces, [(Part(name, "", ""), faces)]))
    named = _named(path, found)
    if len(named) != len(found):
        return found
    return [_with_names(layer, parts) for layer, parts in zip(found, named, strict=True)]


def _with_names(layer: Layer, parts: list[tuple[Part, int]]) -> Layer:
    if not parts:
        return layer
    if sum(count for _, count in parts) == layer.faces:
        return replace(layer, parts=parts)
    objects = {part.object for part, _ in parts}
    name = objects.pop() if len(objects) == 1 else layer.name
    return replace(layer, parts=[(Part(name, "", ""), layer.faces)], is_lost=len(parts) > 1)


def _named(path: Path, found: Sequence[Layer]) -> list[list[tuple[Part, int]]]:
    """The parts of each layer and their faces, of formats that are looked into."""
    extension = path.suffix.lower()
    if extension in gltf.EXTENSIONS:
        # The host makes a layer of each node that has a mesh, and calls it as the mesh.
        return [
            [(Part(one.name, "", material), count) for material, count in one.materials]
            for one in gltf.objects(path)
        ]
    if extension == ".3mf":
        return [
            [(Part(one.name, "", run.material), run.triangles) for run in one.runs]
            for one in threemf.built(path)
        ]
    if extension == ".3ds":
        runs = three_ds.runs_of_layers(path, [(layer.name, layer.faces) for layer in found])
        return [
            [(Part(layer.name, "", material), count) for material, count in own]
            for layer, own in zip(found, runs, strict=True)
        ]
    if extension == ".dae":
        return [[(Part(one.object, "", one.material), one.triangles) for one in collada.runs(path)]]
    if extension == ".stl":
        solids = stl.solids(path)
        names = [one.name or (f"object {i}" if i else "") for i, one in enumerate(solids)]
        return [
            [
                (Part(name, "", ""), len(one.triangles))
                for name, one in zip(names, solids, strict=True)
            ]
        ]
    return []


def join(path: Path, meshes: Any, chosen: Sequence[str]) -> tuple[list[Part], list[str]]:
    """Makes one mesh of the objects of a file, each where its matrix puts it.

    Args:
        path: the file.
        meshes: a MeshSet that holds what the host made of it; one mesh is left of it.
        chosen: names of the objects to take; none: all.

    Returns:
        The parts that the attribute part_id of the faces counts from 0, and warnings. Where there
        is one part only, there is no attribute.

    Raises:
        DevsegError: for a name that the file does not have.
    """
    found = layers(path, meshes)
    if not found:
        raise DevsegError(f"{path}: expected a mesh, found none; export it again")
    parts, warnings = _label(path, meshes, found)
    if chosen:
        _leave_out(path, meshes, parts, chosen)
    ids = []
    for layer in found:
        meshes.set_current_mesh(layer.id)
        if meshes.current_mesh().face_number() == 0 and _count(meshes) > 1:
            if layer.faces == 0 and not chosen:
                warnings.append(f"object '{layer.name}' has no faces and was left out")
            meshes.delete_current_mesh()
        else:
            _apply_matrix(meshes)
            ids.append(_own_ids(meshes.current_mesh()))
    if _count(meshes) > 1:
        # Whose corners are one vertex is for the filters to say: all vertices stay.
        meshes.generate_by_merging_visible_meshes(mergevertices=False)
        meshes.set_mesh_name(newname=path.name)
    return _number(meshes.current_mesh(), parts, ids), warnings


def turn(meshes: Any, up: str, back: bool = False) -> None:
    """Turns the mesh so that `up` becomes y, or back; coordinates change places and signs only."""
    if up == "y":
        return
    import numpy as np

    matrix = np.eye(4)
    rotation = np.array(UPRIGHT[up], dtype=float)
    matrix[:3, :3] = rotation.T if back else rotation
    meshes.set_matrix(transformmatrix=matrix, freeze=True)


def part_ids(mesh: Any, parts: Sequence[Part]) -> Any:
    """For each face the index of its part, #F."""
    import numpy as np

    if len(parts) < 2:
        return np.zeros(mesh.face_number(), dtype=np.int64)
    return mesh.face_custom_scalar_attribute_array(PART_ATTRIBUTE).astype(np.int64)


def counted(mesh: Any, parts: Sequence[Part]) -> list[dict[str, Any]]:
    """The names of the parts and their faces, for NAME.json."""
    import numpy as np

    faces = np.bincount(part_ids(mesh, parts), minlength=len(parts)).tolist()
    return [{**asdict(part), "faces": n} for part, n in zip(parts, faces, strict=True)]


def comments(parts: Sequence[Part]) -> list[str]:
    """The names of the parts as lines of a PLY header."""
    return [
        f"{PART_ATTRIBUTE} {i}: "
        + ", ".join(f"{kind} {name}" for kind, name in asdict(part).items() if name)
        for i, part in enumerate(parts)
        if any(asdict(part).values())
    ]


def _count(meshes: Any) -> int:
    # pymeshlab 2022.2 calls it number_meshes.
    return (getattr(meshes, "mesh_number", None) or meshes.number_meshes)()


def _label(path: Path, meshes: Any, found: list[Layer]) -> tuple[list[Part], list[str]]:
    """Gives the faces of all layers the numbers of their parts."""
    parts: list[Part] = []
    is_lost = any(layer.is_lost for layer in found)
    for layer in found:
        mesh = meshes.mesh(layer.id)
        own, ids = _numbered(layer)
        if path.suffix.lower() == ".obj":
            named = obj_parts.read(path)
            followed = obj_parts.parts_of_faces(named, mesh.face_matrix())
            if followed is not None:
                own, ids = named.parts, followed
            else:
                is_lost = True
        elif path.suffix.lower() == ".ply" and (written := ply.part_ids(path, layer.faces)):
            own, ids = [_part_in(text) for text in written[0]], written[1]
        if layer.faces:
            mesh.add_face_custom_scalar_attribute(ids + float(len(parts)), _LAYER_ATTRIBUTE)
        parts += own
    lost = "names of objects, groups and materials are lost: the faces are not as in the file"
    return parts, [lost] if is_lost else []


def _part_in(text: str) -> Part:
    """The part that a line of `comments` tells of."""
    names = {"object": "", "group": "", "material": ""}
    for kind, name in _NAMED.findall(text):
        names[kind] = name
    return Part(**names)


def _numbered(layer: Layer) -> tuple[list[Part], Any]:
    """The parts of a layer, and for each face the index of its part."""
    import numpy as np

    parts = list(dict.fromkeys(part for part, _ in layer.parts))
    numbers = [float(parts.index(part)) for part, _ in layer.parts]
    return parts, np.repeat(numbers, [count for _, count in layer.parts])


def _leave_out(path: Path, meshes: Any, parts: list[Part], chosen: Sequence[str]) -> None:
    """Removes the faces of all objects that are not chosen."""
    known = list(dict.fromkeys(part.object for part in parts))
    for name in chosen:
        if name not in known:
            shown = ", ".join(repr(one) for one in known[:_SHOWN])
            more = f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else ""
            raise DevsegError(
                f"{path}: expected an object of the file ({shown}{more}), found {name!r}; "
                "devseg run FILE --list-objects lists them"
            )
    others = [i for i, part in enumerate(parts) if part.object not in chosen]
    for mesh in list(meshes):
        if not others or mesh.face_number() == 0:
            continue
        meshes.set_current_mesh(mesh.id())
        condition = " || ".join(f"({_LAYER_ATTRIBUTE} == {i})" for i in others)
        meshes.compute_selection_by_condition_per_face(condselect=condition)
        if mesh.selected_face_number():
            meshes.meshing_remove_selected_faces()
            meshes.meshing_remove_unreferenced_vertices()


def _apply_matrix(meshes: Any) -> None:
    import numpy as np

    matrix = meshes.current_mesh().transform_matrix()
    if np.array_equal(matrix, np.eye(4)):
        return
    if np.linalg.det(matrix[:3, :3]) < 0:
        # A mirror image has its inside out.
        meshes.meshing_invert_face_orientation(forceflip=True)
    meshes.apply_matrix_freeze()


def _own_ids(mesh: Any) -> Any:
    import numpy as np

    if mesh.face_number() == 0:
        return np.zeros(0)
    return mesh.face_custom_scalar_attribute_array(_LAYER_ATTRIBUTE)


def _number(mesh: Any, parts: list[Part], ids: Sequence[Any]) -> list[Part]:
    """Gives the faces the numbers of those parts that have faces, where there are several.

    Attributes are lost where the host joins meshes; faces stay in the order of the meshes.
    """
    import numpy as np

    used, new = np.unique(np.concatenate(ids), return_inverse=True)
    if len(used) > 1:
        mesh.add_face_custom_scalar_attribute(new.astype(float), PART_ATTRIBUTE)
    return [parts[int(i)] for i in used] or parts[:1]
