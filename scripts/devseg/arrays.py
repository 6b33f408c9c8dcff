"""Charts, flattening and patterns of meshes as arrays.

#V and #F are the numbers of vertices and faces. Lengths are units of the model unless a name ends
in _mm. Arrays that are handed in are copied, never changed. Every function takes
`progress(share, what)`, called with the share of the work that is done, from 0 to 1; the work is
cancelled where it returns False. Options are the parameters of the filters, see docs/filters.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from devseg.array_session import (
    ArraySession,
    array_session,
    checked_mesh,
    checked_rows,
    known_options,
    known_word,
)
from devseg.array_types import Atlas, Charts, Preview
from devseg.errors import DevsegError
from devseg.methods import EFFORTS, FLATTENINGS, METHODS, Method
from devseg.pipeline import (
    DEFORM_FILTER,
    FLATTEN_FILTER,
    PARAMETRIZATION_MEASURES,
    SEGMENTATION_MEASURES,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike

    from devseg.observer import ProgressFunction

PREVIEW_FILTER = "generate_sewn_preview"

# Shares of the time of an unwrapping, as they are for meshes of some ten thousand faces.
_SEGMENT_SHARE, _FLATTEN_SHARE = 0.75, 0.2
_BOTH_SHARE = _SEGMENT_SHARE + _FLATTEN_SHARE


def segment(
    vertices: ArrayLike,
    faces: ArrayLike,
    method: str = "dcharts",
    *,
    progress: ProgressFunction | None = None,
    **options: Any,
) -> Charts:
    """Divides a mesh into few, nearly developable charts, each a disk.

    Args:
        vertices: #V by 3.
        faces: #F by 3, whole numbers.
        method: dcharts (Julius, Kraevoy, Sheffer 2005), t-flooding, plush, papercraft, vsa, mcgim;
            docs/methods has a page with the paper of each.
        progress: see the module.
        options: parameters of the method's filter, such as `charts_number=12`.

    Raises:
        DevsegError: for arrays of other shapes, a mesh that cannot be worked on, or a value out of
            its range: what was expected, what was found and what to do.
        Cancelled: where `progress` returned False.
    """
    points, triangles = checked_mesh(vertices, faces)
    with array_session(progress) as session:
        session.add(points, triangles)
        session.observation.part(0, 1)
        made = _segment(session, method, options)
        measures = {**made, **session.apply(SEGMENTATION_MEASURES)}
        return Charts(points, triangles, *session.charts(), measures, tuple(session.warnings))


def unwrap(
    vertices: ArrayLike,
    faces: ArrayLike,
    method: str = "dcharts",
    *,
    charts: ArrayLike | Charts | None = None,
    flatten: str | None = None,
    pack: bool = True,
    effort: str = "normal",
    progress: ProgressFunction | None = None,
    **options: Any,
) -> Atlas:
    """Divides a mesh into charts, lays each flat without overlaps, and packs them.

    Args:
        vertices: #V by 3.
        faces: #F by 3, whole numbers.
        method: as for `segment`.
        charts: charts to flatten instead of making them: those of `segment`, or #F whole numbers.
            Charts that are no disks are cut open.
        flatten: symmetric-dirichlet (Smith, Schaefer 2015), lscm, abf, arap or lpfb; None: as
            fits the method.
        pack: whether charts are nested in the unit square; else they stand in rows.
        effort: of packing: fast, normal or best.
        progress: see the module.
        options: parameters of the method's filter.

    Raises:
        DevsegError: as `segment`.
        Cancelled: where `progress` returned False.
    """
    points, triangles = checked_mesh(vertices, faces)
    flattening = known_word("flatten", flatten or _method(method).flatten, FLATTENINGS)
    packing = known_word("effort", effort, EFFORTS)
    with array_session(progress) as session:
        if charts is None:
            session.add(points, triangles)
            session.observation.part(0, _SEGMENT_SHARE)
            _segment(session, method, options)
            session.observation.part(_SEGMENT_SHARE, _FLATTEN_SHARE)
        else:
            if options:
                raise DevsegError(f"{next(iter(options))}: expected no options beside charts")
            session.add(points, triangles, *_given_charts(charts, len(triangles)))
            session.observation.part(0, _BOTH_SHARE)
        session.apply(FLATTEN_FILTER, method=flattening, pack=pack, effort=packing)
        session.observation.part(_BOTH_SHARE, 1 - _BOTH_SHARE)
        measures = session.apply(PARAMETRIZATION_MEASURES)
        uv = session.meshes.current_mesh().wedge_tex_coord_matrix().reshape(-1, 3, 2)
        return Atlas(points, triangles, *session.charts(), measures, tuple(session.warnings), uv)


def deform(charts: Charts, *, progress: ProgressFunction | None = None, **options: Any) -> Charts:
    """Moves vertices a little, so that the charts unfold without any stretch.

    Args:
        charts: of `segment` or `unwrap`; papercraft is meant for it.
        progress: see the module.
        options: parameters of `apply_coord_developable_charts`, such as `tolerance=1e-6` (radians).

    Returns:
        The charts with other vertices, and slits where vertices were blocked. Measures are the
        filter's results.

    Raises:
        DevsegError: as `segment`, and where the tolerance cannot be reached.
        Cancelled: where `progress` returned False.
    """
    with array_session(progress) as session:
        session.add(charts.vertices, charts.faces, charts.chart_id, charts.seam_edges)
        made = session.apply(DEFORM_FILTER, **known_options(DEFORM_FILTER, session.meshes, options))
        points = session.meshes.current_mesh().vertex_matrix()
        return Charts(points, charts.faces, *session.charts(), made, tuple(session.warnings))


def sewn_preview(
    atlas: Atlas, *, progress: ProgressFunction | None = None, **options: Any
) -> Preview:
    """Sews the pieces of an atlas together and stuffs them, to see what will come out.

    Args:
        atlas: of `unwrap`.
        progress: see the module.
        options: parameters of `generate_sewn_preview`, such as `stuffing=0.01`.

    Raises:
        DevsegError: as `segment`.
        Cancelled: where `progress` returned False.
    """
    with array_session(progress) as session:
        session.add_atlas(atlas)
        known = known_options(PREVIEW_FILTER, session.meshes, options)
        made = session.apply(PREVIEW_FILTER, **known)
        mesh = session.meshes.current_mesh()
        return Preview(
            mesh.vertex_matrix(),
            mesh.face_matrix(),
            mesh.face_scalar_array(),
            made,
            tuple(session.warnings),
        )


def _segment(session: ArraySession, method: str, options: dict[str, Any]) -> dict[str, Any]:
    name = _method(method).filter
    return session.apply(name, **known_options(name, session.meshes, options))


def _method(word: str) -> Method:
    return known_word("method", word, METHODS)


def _given_charts(charts: ArrayLike | Charts, faces: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Labels and, where they are known, cuts."""
    import numpy as np

    if isinstance(charts, Charts):
        return charts.chart_id, charts.seam_edges
    return checked_rows("charts", charts, (faces,), np.integer), None
