"""Filters of the host on arrays: the arrays are checked, copied, and given back."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from devseg import host
from devseg.errors import Cancelled, DevsegError
from devseg.observer import Observation, ProgressFunction, observed
from devseg.pipeline import Session
from devseg.plugins import load_plugins

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike

    from devseg.array_types import Atlas

T = TypeVar("T")

# The host counts vertices and faces in 32 bits.
_MOST_VERTICES = 2**31

# The host is one for all threads, and so is what it prints.
_lock = threading.RLock()
# None may die, see load.py; those that are free are empty.
_free: list[Any] = []


class ArraySession(Session):
    """Filters on a mesh of arrays; failures are told in the filters' own words."""

    def __init__(self, meshes: Any, observation: Observation) -> None:
        super().__init__(Path(), meshes)
        self.observation = observation

    def failure(self, message: str) -> DevsegError:
        """A filter's message as it is."""
        return Cancelled(message) if self.observation.cancelled else DevsegError(message)

    def add(
        self,
        vertices: np.ndarray,
        faces: np.ndarray,
        chart_id: np.ndarray | None = None,
        seam_edges: np.ndarray | None = None,
        uv: np.ndarray | None = None,
    ) -> None:
        """Adds a mesh, whose charts and texture coordinates are those of the filters."""
        import numpy as np

        given = {} if uv is None else {"w_tex_coords_matrix": uv.reshape(-1, 2)}
        self.meshes.add_mesh(host.pymeshlab().Mesh(vertices, faces, **given))
        mesh = self.meshes.current_mesh()
        if chart_id is not None:
            mesh.add_face_custom_scalar_attribute(chart_id.astype(np.float64), "chart_id")
        if seam_edges is not None:
            bits = seam_edges @ np.array([1.0, 2.0, 4.0])
            mesh.add_face_custom_scalar_attribute(bits, "seam_edges")

    def add_atlas(self, atlas: Atlas) -> None:
        """Adds an atlas with all that it has."""
        self.add(atlas.vertices, atlas.faces, atlas.chart_id, atlas.seam_edges, atlas.uv)

    def charts(self) -> tuple[np.ndarray, np.ndarray]:
        """The charts and the cuts of the current mesh."""
        import numpy as np

        mesh = self.meshes.current_mesh()
        bits = mesh.face_custom_scalar_attribute_array("seam_edges").astype(np.int64)
        charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(np.int64)
        return charts, (bits[:, None] & np.array([1, 2, 4])) != 0


@contextlib.contextmanager
def array_session(progress: ProgressFunction | None) -> Iterator[ArraySession]:
    """A session without a mesh yet; one at a time in this process.

    Raises:
        Cancelled: where `progress` returned False.
    """
    with _lock:
        load_plugins()
        meshes = _free.pop() if _free else host.pymeshlab().MeshSet()
        observation = Observation(progress)
        session = ArraySession(meshes, observation)
        try:
            with observed(observation):
                yield session
        except DevsegError:
            if observation.error is not None:
                raise observation.error from None
            raise
        finally:
            meshes.clear()
            _free.append(meshes)


def checked_mesh(vertices: ArrayLike, faces: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Copies of the arrays as the host takes them: 64-bit floats and 32-bit integers.

    Raises:
        DevsegError: for other shapes, numbers that are not finite, and faces that name vertices
            that there are not.
    """
    import numpy as np

    points = np.array(vertices, dtype=np.float64, order="C")
    if points.ndim != 2 or points.shape[1] != 3:
        raise DevsegError(
            f"vertices: expected an array of #V by 3 coordinates, found {_shape(points)}"
        )
    if not np.isfinite(points).all():
        row = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise DevsegError(f"vertices: expected finite coordinates, found others in row {row}")
    triangles = np.asarray(faces)
    if triangles.ndim != 2 or triangles.shape[1] != 3:
        raise DevsegError(
            f"faces: expected an array of #F by 3 vertex indices, found {_shape(triangles)}; "
            "divide larger faces into triangles"
        )
    if not np.issubdtype(triangles.dtype, np.integer):
        raise DevsegError(f"faces: expected whole numbers, found {triangles.dtype}")
    if len(triangles) == 0:
        raise DevsegError("faces: expected at least one triangle, found none")
    low, high = int(triangles.min()), int(triangles.max())
    if low < 0 or high >= min(len(points), _MOST_VERTICES):
        raise DevsegError(
            f"faces: expected vertex indices from 0 to {len(points) - 1}, "
            f"found {low if low < 0 else high}"
        )
    return points, np.array(triangles, dtype=np.int32, order="C")


def checked_rows(name: str, values: ArrayLike, shape: tuple[int, ...], kind: type) -> np.ndarray:
    """A copy of an array that has a row for each face.

    Raises:
        DevsegError: for another shape, or values of another kind.
    """
    import numpy as np

    found = np.asarray(values)
    if found.shape != shape:
        wanted = " by ".join(map(str, shape))
        raise DevsegError(f"{name}: expected an array of {wanted}, found {_shape(found)}")
    if not np.issubdtype(found.dtype, kind):
        raise DevsegError(f"{name}: expected {kind.__name__} values, found {found.dtype}")
    return np.array(found, order="C")


def known_word(name: str, word: str, known: Mapping[str, T]) -> T:
    """What a word stands for.

    Raises:
        DevsegError: for another word.
    """
    if word not in known:
        raise DevsegError(f"{name}: expected one of {', '.join(known)}, found {word!r}")
    return known[word]


def known_options(
    filter_name: str, meshes: Any, options: Mapping[str, Any], without: tuple[str, ...] = ()
) -> dict[str, Any]:
    """The options as the host takes them, all of which are parameters of the filter.

    Raises:
        DevsegError: for a word that the filter does not know, with those that it knows, and for
            something that is neither a number nor a text.
    """
    known = [n for n in meshes.filter_parameter_values(filter_name) if n not in without]
    found = {}
    for name, value in options.items():
        if name not in known:
            raise DevsegError(f"{name}: expected one of {', '.join(known)}")
        found[name] = value.item() if hasattr(value, "item") else value  # a number of NumPy
        if not isinstance(found[name], bool | int | float | str):
            raise DevsegError(f"{name}: expected a number or a text, found {value!r}")
    return found


def _shape(array: np.ndarray) -> str:
    return " by ".join(map(str, array.shape)) or "a single value"
