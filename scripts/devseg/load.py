"""Reading a mesh, with errors that a person can act upon."""

from __future__ import annotations

import contextlib
import re
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from devseg import collada, gltf, gltf_triangles, host, obj, ply, scene, stl, threemf
from devseg.apart import limited_reading
from devseg.errors import DevsegError, host_message
from devseg.frame import Frame, read_frame
from devseg.obj_parts import Part

# What pymeshlab itself reports about a mesh that it changed while loading.
_CORRECTED = re.compile(r"contains (\d+) vertices with NAN coords and (\d+) degenerated faces")

# What is looked at before the host reads a file: its readers trust what files say.
_CHECKS = {
    ".ply": ply.check_size,
    ".obj": obj.check_indices,
    **dict.fromkeys(gltf.EXTENSIONS, gltf.check),
}

# pymeshlab's progress callback keeps a pointer to the log of a MeshSet that has loaded a file, and
# uses it while others load or save: none of them may die. Their meshes may, see release().
_loggers: list[Any] = []


def release() -> None:
    """Frees the meshes of all files loaded so far."""
    for meshes in _loggers:
        meshes.clear()


@dataclass(frozen=True)
class Loaded:
    """What a file has become.

    Attributes:
        meshes: a MeshSet with one mesh, which holds all objects of the file that were asked for.
        warnings: what was changed on the way, or may surprise.
        frame: the unit and the upward axis, as far as the format tells them.
        parts: objects, groups and materials; the face attribute part_id counts them.
    """

    meshes: Any
    warnings: list[str]
    frame: Frame
    parts: list[Part]


def load_mesh(path: Path, objects: Sequence[str] = ()) -> Loaded:
    """Reads the objects of a file, all or those of the given names, as one mesh.

    Raises:
        DevsegError: for a file that is missing, cannot be read, holds no faces, not the objects
            that are asked for, or coordinates that are no finite numbers.
    """
    meshes, log, notes = _read(path)
    try:
        with host.captured():
            parts, warnings = scene.join(path, meshes, objects)
    except host.pymeshlab().PyMeshLabException as error:
        raise DevsegError(f"{path}: objects cannot be joined ({host_message(error)})") from error
    warnings += _check(path, meshes, log) + _turn_outside(meshes)
    return Loaded(meshes, notes + warnings, read_frame(path), parts)


def list_objects(path: Path) -> dict[str, int]:
    """The names of the objects of a file, and their faces.

    Raises:
        DevsegError: as load_mesh.
    """
    loaded = load_mesh(path)
    ids = scene.part_ids(loaded.meshes.current_mesh(), loaded.parts).tolist()
    found: dict[str, int] = {}
    for part, faces in Counter(ids).items():
        name = loaded.parts[part].object
        found[name] = found.get(name, 0) + faces
    return found


def _read(path: Path) -> tuple[Any, str, list[str]]:
    """A MeshSet with the layers of a file, what the host said, and what of it was left out."""
    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise DevsegError(f"{path}: expected a mesh file, found {found}; check the name")
    try:
        with path.open("rb") as file:
            is_empty = not file.read(1)
    except OSError as error:
        raise DevsegError(
            f"{path}: cannot be opened ({error.strerror}); check permissions"
        ) from error
    if is_empty:
        raise DevsegError(f"{path}: expected a mesh file, found an empty one; export it again")
    check = _CHECKS.get(path.suffix.lower())
    if check is not None:
        check(path)
    pymeshlab = host.pymeshlab()
    try:
        # Verbose, as only its log tells that vertices were dropped.
        with host.captured() as chatter, _for_the_host(path) as (readable, notes):
            host.need_readers(readable.suffix.lower())
            meshes = pymeshlab.MeshSet(True)
            _loggers.append(meshes)
            try:
                with limited_reading(path.stat().st_size):
                    meshes.load_new_mesh(str(readable))
            finally:
                # All plugins would go on logging to this MeshSet after its end.
                meshes.set_verbosity(False)
    except (pymeshlab.PyMeshLabException, MemoryError) as error:
        raise DevsegError(f"{path}: {_load_message(path, error)}") from error
    return meshes, chatter.text, notes


@contextlib.contextmanager
def _for_the_host(path: Path) -> Iterator[tuple[Path, list[str]]]:
    """The file, or one that says the same so that the host can read it; what it leaves out."""
    extension = path.suffix.lower()
    with tempfile.TemporaryDirectory(prefix="devseg-") as folder:
        if extension in gltf.EXTENSIONS:
            yield gltf_triangles.rewritten(path, Path(folder))
        elif extension == ".dae":
            yield collada.rewritten(path, Path(folder))
        elif extension == ".3mf":
            yield threemf.rewritten(path, Path(folder))
        elif extension == ".stl":
            yield stl.rewritten(path, Path(folder)), []
        else:
            yield path, []


def _turn_outside(meshes: Any) -> list[str]:
    """Turns the faces of a solid that look inwards; says so."""
    from devseg.orient import is_inside_out

    mesh = meshes.current_mesh()
    if not is_inside_out(mesh.vertex_matrix(), mesh.face_matrix()):
        return []
    with host.captured():
        meshes.meshing_invert_face_orientation(forceflip=True)
    return ["the solid is inside out: its faces looked inwards and were turned"]


def _load_message(path: Path, error: BaseException) -> str:
    message = host_message(error)
    if message.startswith("Unknown format"):
        found = path.suffix or "no extension"
        return f"expected a mesh format such as .ply, .obj, .stl or .off, found {found}"
    message = re.sub(r"^Unable to open file: \S.*?(Error|$)", r"\1", message)
    return (
        f"cannot be read as {path.suffix[1:].upper()} ({message or _unsaid(path)}); "
        "export it again, or as another format"
    )


def _unsaid(path: Path) -> str:
    """What is known of a fault of which the host tells nothing."""
    if path.suffix.lower() in gltf.EXTENSIONS:  # its triangles have been looked at
        return "its triangles are in order, but not what is beside them, such as its materials"
    return "no reason given"


def _check(path: Path, meshes: Any, log: str) -> list[str]:
    import numpy as np

    mesh = meshes.current_mesh()
    found = _CORRECTED.findall(log)  # once for each object
    dropped = [sum(int(one[k]) for one in found) for k in (0, 1)]
    if dropped[0] or not np.isfinite(mesh.vertex_matrix()).all():
        raise DevsegError(
            f"{path}: expected finite coordinates, found NaN or infinite ones (vertices: "
            f"{dropped[0] or 'some'}); repair the file or export it again"
        )
    if mesh.face_number() == 0:
        raise DevsegError(
            f"{path}: expected a triangle mesh, found no faces ({mesh.vertex_number()} points); "
            "make a surface of the points first, in MeshLab for example"
        )
    if dropped[1]:
        return [f"{dropped[1]} faces that repeat a vertex were dropped while loading"]
    return []
