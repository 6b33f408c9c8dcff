"""What the functions on arrays return. #V and #F are the numbers of vertices and of faces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True, eq=False)
class Charts:
    """A mesh that is divided into charts.

    Attributes:
        vertices: #V by 3, float64.
        faces: #F by 3, int32, vertex indices.
        chart_id: #F, int64, the chart of each face, from 0.
        seam_edges: #F by 3, bool: whether the face's edges (v0v1), (v1v2), (v2v0) are cut. Both
            faces of an edge agree.
        measures: results of the method and of `get_segmentation_measures`, by name.
        warnings: what the filters worked around, or what may surprise.
    """

    vertices: np.ndarray
    faces: np.ndarray
    chart_id: np.ndarray
    seam_edges: np.ndarray
    measures: Mapping[str, Any]
    warnings: tuple[str, ...]

    @property
    def charts_number(self) -> int:
        """How many charts there are."""
        return int(self.chart_id.max()) + 1


@dataclass(frozen=True, eq=False)
class Atlas(Charts):
    """Charts that lie flat, side by side in the unit square.

    Attributes:
        uv: #F by 3 by 2, float64, texture coordinates of each corner of each face. All charts have
            one scale: that of their areas on the surface.
        measures: results of `get_parametrization_measures`, by name: stretch, flips, overlaps,
            packing, and arrays with a value for each chart.
    """

    uv: np.ndarray

    def cut(self) -> CutMesh:
        """The same mesh with a vertex for each of its texture coordinates."""
        import numpy as np

        corners = np.column_stack(
            [self.faces.reshape(-1).astype(np.float64), self.uv.reshape(-1, 2)]
        )
        rows, places = np.unique(corners, axis=0, return_inverse=True)
        origin = rows[:, 0].astype(np.int64)
        return CutMesh(
            self.vertices[origin], places.reshape(-1, 3).astype(np.int32), rows[:, 1:], origin
        )


@dataclass(frozen=True, eq=False)
class CutMesh:
    """A mesh that is cut along its seams, as renderers want it.

    Attributes:
        vertices: #W by 3.
        faces: #F by 3, in the order of the atlas.
        uv: #W by 2.
        origin: #W, the vertex of the atlas that each vertex was.
    """

    vertices: np.ndarray
    faces: np.ndarray
    uv: np.ndarray
    origin: np.ndarray


@dataclass(frozen=True, eq=False)
class Preview:
    """The pieces of an atlas sewn together and stuffed.

    Attributes:
        vertices: #W by 3, in the frame of the model.
        faces: #G by 3.
        distance: #G, of each face from the model.
        measures: results of `generate_sewn_preview`, by name.
        warnings: what the filter worked around, or what may surprise.
    """

    vertices: np.ndarray
    faces: np.ndarray
    distance: np.ndarray
    measures: Mapping[str, Any]
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Pieces:
    """A pattern as a flat mesh.

    Attributes:
        vertices: #W by 3, in millimetres; z is 0.
        faces: #G by 3.
        piece_id: #G, from 0.
    """

    vertices: np.ndarray
    faces: np.ndarray
    piece_id: np.ndarray
