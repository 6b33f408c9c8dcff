"""Reading a mesh, with errors that a person can act upon."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from devseg import gltf, host, obj, ply
from devseg.errors import DevsegError, host_message

# What pymeshlab itself reports about a mesh that it changed while loading.
_CORRECTED = re.compile(r"contains (\d+) vertices with NAN coords and (\d+) degenerated faces")

# What is looked at before the host reads a file: its readers trust what files say.
_CHECKS = {
    ".ply": ply.check_size,
    ".obj": obj.check_indices,
    ".gltf": gltf.check,
    ".glb": gltf.check,
}

# pymeshlab's progress callback keeps a pointer to the log of a MeshSet that has loaded a file, and
# uses it while others load or save: none of them may die. Their meshes may, see release().
_loggers: list[Any] = []


def release() -> None:
    """Frees the meshes of all files loaded so far."""
    for meshes in _loggers:
        meshes.clear()


def load_mesh(path: Path) -> tuple[Any, list[str]]:
    """A MeshSet that holds the mesh of a file, and warnings about what the loader changed.

    Raises:
        DevsegError: for a file that is missing, cannot be read, holds no faces, several meshes or
            coordinates that are no finite numbers.
    """
    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise DevsegError(f"{path}: expected a mesh file, found {found}; check the name")
    try:
        with path.open("rb") as file:
            file.read(1)
    except OSError as error:
        raise DevsegError(
            f"{path}: cannot be opened ({error.strerror}); check permissions"
        ) from error
    check = _CHECKS.get(path.suffix.lower())
    if check is not None:
        check(path)
    pymeshlab = host.pymeshlab()
    try:
        # Verbose, as only its log tells that vertices were dropped.
        with host.captured() as chatter:
            meshes = pymeshlab.MeshSet(True)
            _loggers.append(meshes)
            try:
                meshes.load_new_mesh(str(path))
            finally:
                # All plugins would go on logging to this MeshSet after its end.
                meshes.set_verbosity(False)
    except (pymeshlab.PyMeshLabException, MemoryError) as error:
        raise DevsegError(f"{path}: {_load_message(path, error)}") from error
    warnings = _check(path, meshes, chatter.text)
    return meshes, warnings


def _load_message(path: Path, error: BaseException) -> str:
    message = host_message(error)
    if message.startswith("Unknown format"):
        found = path.suffix or "no extension"
        return f"expected a mesh format such as .ply, .obj, .stl or .off, found {found}"
    message = re.sub(r"^Unable to open file: \S.*?(Error|$)", r"\1", message)
    return (
        f"cannot be read as {path.suffix[1:].upper()} ({message or 'no reason given'}); "
        "export it again, or as another format"
    )


def _check(path: Path, meshes: Any, log: str) -> list[str]:
    import numpy as np

    # pymeshlab 2022.2 calls it number_meshes.
    count = (getattr(meshes, "mesh_number", None) or meshes.number_meshes)()
    if count != 1:
        raise DevsegError(
            f"{path}: expected one mesh, found {count}; join them first "
            "(generate_by_merging_visible_meshes)"
        )
    mesh = meshes.current_mesh()
    dropped = [0, 0]
    if match := _CORRECTED.search(log):
        dropped = [int(match[1]), int(match[2])]
    if dropped[0] or not np.isfinite(mesh.vertex_matrix()).all():
        raise DevsegError(
            f"{path}: expected finite coordinates, found NaN or infinite ones (vertices: "
            f"{dropped[0] or 'some'}); repair the file or export it again"
        )
    if mesh.face_number() == 0:
        raise DevsegError(
            f"{path}: expected a triangle mesh, found no faces ({mesh.vertex_number()} points); "
            "a point cloud needs a surface reconstruction first "
            "(generate_surface_reconstruction_screened_poisson)"
        )
    if dropped[1]:
        return [f"{dropped[1]} faces that repeat a vertex were dropped while loading"]
    return []
