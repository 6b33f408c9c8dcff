"""`mesh.devseg` on PyVista's meshes of polygons; PyVista finds it by its entry point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pyvista

from devseg.array_types import Atlas, Charts
from devseg.arrays import segment, unwrap
from devseg.errors import DevsegError

if TYPE_CHECKING:
    import numpy as np


@pyvista.register_dataset_accessor("devseg", pyvista.PolyData)
class DevsegAccessor:
    """What devseg makes of a mesh; the mesh itself is not changed.

    Faces of more than three corners are divided into triangles.
    """

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def segment(self, method: str = "dcharts", **options: Any) -> Any:
        """The mesh as triangles with the cell data `chart_id`; options as `devseg.segment`."""
        charts = segment(*self._arrays(), method, **options)
        return _with_charts(charts.vertices, charts.faces, charts)

    def unwrap(self, method: str = "dcharts", **options: Any) -> Any:
        """The mesh cut along its seams, with texture coordinates and `chart_id`.

        The point data `origin` has the numbers that the points had. Options as `devseg.unwrap`.
        """
        cut = (atlas := self.atlas(method, **options)).cut()
        found = _with_charts(cut.vertices, cut.faces, atlas)
        found.active_texture_coordinates = cut.uv
        found.point_data["origin"] = cut.origin
        return found

    def atlas(self, method: str = "dcharts", **options: Any) -> Atlas:
        """The same as arrays, for `devseg.pattern` and `devseg.sewn_preview`."""
        return unwrap(*self._arrays(), method, **options)

    def _arrays(self) -> tuple[np.ndarray, np.ndarray]:
        mesh = self._mesh.triangulate()
        if mesh.n_faces == 0:
            raise DevsegError("expected a mesh with faces, found none")
        return mesh.points, mesh.regular_faces


def _with_charts(vertices: np.ndarray, faces: np.ndarray, charts: Charts) -> Any:
    mesh = pyvista.PolyData.from_regular_faces(vertices, faces)
    mesh.cell_data["chart_id"] = charts.chart_id
    return mesh
