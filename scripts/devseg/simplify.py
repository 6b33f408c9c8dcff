"""Fewer faces, for people who fold or sew: holes closed, the mesh simplified."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from devseg.pipeline import Session

SIMPLIFY_FILTER = "meshing_decimation_quadric_edge_collapse"
TEXTURED_FILTER = "meshing_decimation_quadric_edge_collapse_with_texture"
CLOSE_HOLES_FILTER = "meshing_close_holes"
DISTANCE_FILTER = "get_hausdorff_distance"

# Of the distance from a rim, over that from the surface: rims are seen.
RIM_WEIGHT = 3.0


def close_holes(session: Session, most_edges: int) -> None:
    """Closes holes whose rims have at most so many edges."""
    # Selected faces would be simplified alone.
    session.call(CLOSE_HOLES_FILTER, maxholesize=most_edges, newfaceselected=False)


def simplify(session: Session, target_faces: int, textured: bool = False) -> dict[str, Any]:
    """Replaces the mesh by one of so many faces; how far apart both are, both ways.

    A texture that is to be printed keeps its place on the surface, at some cost of the shape.
    Deviations are shares of the diagonal of the model's box.
    """
    meshes = session.meshes
    # A copy lacks the attributes of the original.
    simplified = meshes.current_mesh_id()
    diagonal = meshes.current_mesh().bounding_box().diagonal()
    session.call("generate_copy_of_current_mesh")
    original = meshes.current_mesh_id()
    meshes.set_current_mesh(simplified)
    keeps = textured and meshes.current_mesh().has_wedge_tex_coord()
    session.call(
        TEXTURED_FILTER if keeps else SIMPLIFY_FILTER,
        targetfacenum=target_faces,
        # Kept rims cost most of the faces: they are simplified, and weigh more than the rest.
        preserveboundary=False,
        boundaryweight=RIM_WEIGHT,
        preservenormal=True,
        **({} if keeps else {"preservetopology": True}),
    )
    ways = [
        session.call(DISTANCE_FILTER, sampledmesh=one, targetmesh=other, samplevert=True)
        for one, other in ((original, simplified), (simplified, original))
    ]
    meshes.set_current_mesh(original)
    session.call("delete_current_mesh")
    meshes.set_current_mesh(simplified)
    return {
        "faces": meshes.current_mesh().face_number(),
        "mean_deviation": max(way["mean"] for way in ways) / diagonal,
        "largest_deviation": max(way["max"] for way in ways) / diagonal,
    }
