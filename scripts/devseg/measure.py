"""`devseg measure`: the measures of a mesh that has texture coordinates, whoever made them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from devseg.apart import READING, Tell, run_apart
from devseg.errors import DevsegError
from devseg.load import load_mesh
from devseg.outputs import plain
from devseg.pipeline import PARAMETRIZATION_MEASURES, SEGMENTATION_MEASURES, Session
from devseg.plugins import load_plugins
from devseg.ply import restore_attributes


def measure(path: Path) -> dict[str, Any]:
    """Measures of the charts and of the flattening.

    Raises:
        DevsegError: for a mesh without texture coordinates.
    """
    return run_apart(str(path), lambda tell: plain(_measure(path, tell)))


def _measure(path: Path, tell: Tell) -> dict[str, Any]:
    load_plugins()
    tell(READING)
    meshes = load_mesh(path).meshes
    tell("measure")
    session = Session(path, meshes)
    mesh = meshes.current_mesh()
    if not mesh.has_wedge_tex_coord():
        if not mesh.has_vertex_tex_coord():
            raise DevsegError(
                f"{path}: expected texture coordinates, found none; flatten it first (devseg run)"
            )
        session.apply("compute_texcoord_transfer_vertex_to_wedge")
    restore_attributes(mesh, path)
    return {
        "input": path.name,
        "mesh": {"vertices": mesh.vertex_number(), "faces": mesh.face_number()},
        "segmentation": session.apply(SEGMENTATION_MEASURES),
        "parametrization": session.apply(PARAMETRIZATION_MEASURES),
    }
