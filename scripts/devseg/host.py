"""The host, pymeshlab: its import, its chatter and the data of its meshes."""

from __future__ import annotations

import contextlib
import ctypes
import functools
import importlib.util
import io
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from devseg.errors import DevsegError
from devseg.requirements import (
    PYMESHLAB,
    installed_version,
    load_stand_ins,
    loading_advice,
    version_advice,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import ModuleType

    import numpy as np


class Chatter:
    """What the host printed during a `captured` block; complete when the block has ended."""

    text = ""


@dataclass(frozen=True)
class _Terminal:
    """Where output went before a `captured` block."""

    descriptors: tuple[int, int]
    streams: tuple[TextIO, TextIO]


_terminals: list[_Terminal] = []

# The host's plugin of the usual formats; it goes on without plugins that it cannot load.
_READERS = "libio_base.so"
_READ_BY_BASE = (".obj", ".off", ".ply", ".stl")
_PLUGINS = Path("lib/plugins")
# What devseg uses of its other plugins: each is loaded when its turn comes, in processes of ours.
_FILTERS = {
    "clean": ("meshing_remove_unreferenced_vertices",),
    "func": ("compute_selection_by_condition_per_face",),
    "layer": (
        "delete_current_mesh",
        "generate_by_merging_visible_meshes",
        "generate_copy_of_current_mesh",
        "set_mesh_name",
    ),
    "meshing": (
        "apply_matrix_freeze",
        "meshing_close_holes",
        "meshing_decimation_quadric_edge_collapse",
        "meshing_decimation_quadric_edge_collapse_with_texture",
        "meshing_invert_face_orientation",
        "set_matrix",
    ),
    "sampling": ("get_hausdorff_distance",),
    "select": ("meshing_remove_selected_faces",),
    "texture": ("compute_texcoord_transfer_vertex_to_wedge",),
}
_is_own = False


@contextlib.contextmanager
def captured() -> Iterator[Chatter]:
    """Keeps what the host prints off the terminal and out of a JSON on stdout.

    C++ code writes to the file descriptors, the bindings to sys.stdout, which need not be the same
    (in a notebook it is not). DEVSEG_DEBUG=1 passes the text on to stderr.
    """
    chatter = Chatter()
    printed = io.StringIO()
    _flush()
    with tempfile.TemporaryFile() as sink:
        saved = os.dup(1), os.dup(2)
        _terminals.append(_Terminal(saved, (sys.stdout, sys.stderr)))
        try:
            os.dup2(sink.fileno(), 1)
            os.dup2(sink.fileno(), 2)
            with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
                yield chatter
        finally:
            # What is still in the C library's buffers belongs to this block.
            _flush()
            _terminals.pop()
            os.dup2(saved[0], 1)
            os.dup2(saved[1], 2)
            os.close(saved[0])
            os.close(saved[1])
            sink.seek(0)
            chatter.text = printed.getvalue() + sink.read().decode(errors="replace")
            if os.environ.get("DEVSEG_DEBUG") and chatter.text:
                sys.stderr.write(chatter.text)


@contextlib.contextmanager
def uncaptured() -> Iterator[None]:
    """Lets a callback print that the host calls inside of a `captured` block."""
    if not _terminals:
        yield
        return
    terminal = _terminals[-1]
    _flush()
    sinks = os.dup(1), os.dup(2)
    try:
        for number, descriptor in enumerate(terminal.descriptors, start=1):
            os.dup2(descriptor, number)
        out, err = terminal.streams
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            yield
            _flush()
    finally:
        for number, sink in enumerate(sinks, start=1):
            os.dup2(sink, number)
            os.close(sink)


def _flush() -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    ctypes.CDLL(None).fflush(None)


def pymeshlab() -> ModuleType:
    """The pymeshlab module; an error that says what to do where it is not installed."""
    if "pymeshlab" in sys.modules:
        return sys.modules["pymeshlab"]
    # A plugin for another version may be refused, or crash.
    if (advice := version_advice()) is not None:
        raise DevsegError(advice)
    load_stand_ins()
    try:
        # It loads some sixty plugins and prints a warning about each that it cannot load.
        with captured() as chatter:
            module = _own_module() if _is_own else importlib.import_module("pymeshlab")
    except ImportError as error:
        raise DevsegError(f"pymeshlab cannot be imported: {loading_advice(str(error))}") from error
    for line in chatter.text.splitlines():
        if "Cannot load library" in line and _READERS in line:
            raise DevsegError(f"pymeshlab cannot read files: {loading_advice(line)}")
    return module


def own_process() -> None:
    """From now on nobody but devseg uses the host in this process: it starts in half the time.

    Plugins of the host are loaded when they are needed. NumPy gets one thread: it starts others for
    products of matrices, of which there are none here.
    """
    global _is_own
    _is_own = True
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def _own_module() -> ModuleType:
    """The module as its own __init__ makes it, but for plugins that are not needed yet."""
    spec = importlib.util.find_spec("pymeshlab")
    if spec is None or spec.origin is None or installed_version("pymeshlab") != PYMESHLAB:
        return importlib.import_module("pymeshlab")
    module = importlib.util.module_from_spec(spec)
    sys.modules["pymeshlab"] = module
    try:
        core = importlib.import_module("pymeshlab.pmeshlab")
    except BaseException:
        del sys.modules["pymeshlab"]
        raise
    vars(module).update({name: one for name, one in vars(core).items() if name[0] != "_"})
    plugins = Path(spec.origin).parent / _PLUGINS
    _need(module, plugins / _READERS)
    for plugin, names in _FILTERS.items():
        need = functools.partial(_need, module, plugins / f"libfilter_{plugin}.so")
        for name in names:
            setattr(module.MeshSet, name, filter_method(name, need))
    return module


@functools.cache
def _need(module: ModuleType, plugin: Path) -> None:
    """Loads a plugin of the host, once; as the host does, goes on where it cannot be loaded."""
    try:
        module.load_plugin(str(plugin))
    except module.PyMeshLabException as error:
        print(f"Cannot load library {plugin}: {error}")


def need_readers(extension: str) -> None:
    """Has the plugins loaded that may read files with this extension."""
    module = pymeshlab()
    if _is_own and extension not in _READ_BY_BASE:
        for plugin in sorted((Path(str(module.__file__)).parent / _PLUGINS).glob("libio_*.so")):
            _need(module, plugin)


def filter_method(
    name: str, first: Callable[[], None] | None = None
) -> Callable[..., dict[str, Any] | None]:
    """A method that applies a filter, as pymeshlab binds its own: a result only if not empty.

    Args:
        name: of the filter.
        first: called before the filter is.
    """

    def apply(self: Any, **parameters: Any) -> dict[str, Any] | None:
        if first is not None:
            first()
        return self.apply_filter(name, **parameters) or None

    apply.__name__ = name
    apply.__qualname__ = f"MeshSet.{name}"
    apply.__doc__ = f"Applies the filter {name}; see docs/filters.md."
    return apply


@dataclass(frozen=True)
class MeshData:
    """A mesh with its flattening, as arrays.

    Attributes:
        vertices: #V by 3.
        faces: #F by 3, vertex indices.
        texcoords: #F by 3 by 2, of every face corner.
        charts: #F, the chart of every face, 0 to n-1.
        seams: #F by 3, whether the face's edges (v0v1), (v1v2), (v2v0) are cut.
        colors: #F by 3, red, green, blue from 0 to 1.
    """

    vertices: np.ndarray
    faces: np.ndarray
    texcoords: np.ndarray
    charts: np.ndarray
    seams: np.ndarray
    colors: np.ndarray


def mesh_data(mesh: Any) -> MeshData:
    """The arrays of a pymeshlab mesh that carries charts, seams and texture coordinates."""
    import numpy as np

    seams = mesh.face_custom_scalar_attribute_array("seam_edges").astype(np.int64)
    return MeshData(
        vertices=mesh.vertex_matrix(),
        faces=mesh.face_matrix().astype(np.int64),
        texcoords=mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2),
        charts=mesh.face_custom_scalar_attribute_array("chart_id").astype(np.int64),
        seams=(seams[:, None] & np.array([1, 2, 4])) != 0,
        colors=mesh.face_color_matrix()[:, :3],
    )
