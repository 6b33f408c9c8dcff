"""Meshes of trimesh, which need not be installed, to arrays and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from devseg.array_types import Atlas, Charts
from devseg.errors import DevsegError

if TYPE_CHECKING:
    import numpy as np


def from_trimesh(mesh: Any) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, #V by 3, and faces, #F by 3, of a trimesh.Trimesh.

    Raises:
        DevsegError: for something else, such as a scene.
    """
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        raise DevsegError(
            f"expected a trimesh.Trimesh, found {type(mesh).__name__}; a scene gives one by "
            "scene.to_mesh()"
        )
    import numpy as np

    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def to_trimesh(charts: Charts | Atlas) -> Any:
    """A trimesh.Trimesh with the face attribute chart_id.

    That of an atlas is cut along its seams and has texture coordinates; its vertex attribute origin
    has the numbers that its vertices had. Faces keep their order.

    Raises:
        DevsegError: where trimesh is not installed.
    """
    try:
        import trimesh
    except ImportError as error:
        raise DevsegError(
            "to_trimesh needs trimesh, which is not installed; pip install trimesh"
        ) from error

    attributes = {"chart_id": charts.chart_id}
    if not isinstance(charts, Atlas):
        return trimesh.Trimesh(
            charts.vertices, charts.faces, face_attributes=attributes, process=False
        )
    cut = charts.cut()
    return trimesh.Trimesh(
        cut.vertices,
        cut.faces,
        face_attributes=attributes,
        # Wider integers cannot be written as GLB.
        vertex_attributes={"origin": cut.origin.astype("uint32")},
        visual=trimesh.visual.TextureVisuals(uv=cut.uv),
        process=False,
    )
