"""`devseg run`: one mesh in, its pattern, coloured mesh, picture and measures out."""

from __future__ import annotations

import importlib.metadata
import platform
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from devseg import host
from devseg.apart import READING, Tell, run_apart
from devseg.errors import DevsegError, host_message
from devseg.load import load_mesh
from devseg.methods import FLATTENINGS, Method
from devseg.outputs import staged, to_json
from devseg.pattern import EXPORT_FILTER, PATTERN_FORMATS
from devseg.plugins import load_plugins
from devseg.progress import Progress

SIMPLIFY_FILTER = "meshing_decimation_quadric_edge_collapse"
DISTANCE_FILTER = "get_hausdorff_distance"
DEFORM_FILTER = "apply_coord_developable_charts"
FLATTEN_FILTER = "compute_texcoord_parametrization_charts_per_wedge"
SEGMENTATION_MEASURES = "get_segmentation_measures"
PARAMETRIZATION_MEASURES = "get_parametrization_measures"


# What a verbose host prints for each line of a filter's log, and for its progress.
_LOGGED = re.compile(r"^LOG: \d+ (.*)$", re.MULTILINE)
_PROGRESS = re.compile(r"\[ +\d+% \]$")


@dataclass(frozen=True)
class RunOptions:
    """What `devseg run` is to do with every input.

    Attributes:
        out: folder of the outputs.
        method: segmentation method.
        segmentation: parameters of its filter that differ from the defaults.
        flatten: key of FLATTENINGS.
        formats: svg, pdf, dxf, ply, obj.
        pattern: parameters of the export filter that differ from the defaults.
        target_faces: simplify the mesh to so many faces first; None: leave it.
    """

    out: Path
    method: Method
    segmentation: Mapping[str, Any]
    flatten: str
    formats: tuple[str, ...]
    pattern: Mapping[str, Any]
    target_faces: int | None = None


class Session:
    """The filters applied to one mesh, with the parameters that were in force."""

    def __init__(self, path: Path, meshes: Any) -> None:
        self.path = path
        self.meshes = meshes
        self.parameters: dict[str, dict[str, Any]] = {}
        self.warnings: list[str] = []
        self._chatter = ""  # what the host printed last

    def apply(self, name: str, **parameters: Any) -> dict[str, Any]:
        """Applies a filter and returns its results.

        Raises:
            DevsegError: with the filter's own message.
        """
        values = self._guard(self.meshes.filter_parameter_values, name, **parameters)
        if values:
            self.parameters[name] = values
        return self._guard(self.meshes.apply_filter, name, **parameters) or {}

    def segment(self, name: str, **parameters: Any) -> dict[str, Any]:
        """The same for the filter that reads the mesh first; what it worked around is a warning.

        The host drops texts from results, but logs them.
        """
        results = self.apply(name, **parameters)
        values = tuple(f"{result}: " for result in results)
        self.warnings += [
            note.rstrip()
            for note in _LOGGED.findall(self._chatter)
            if not _PROGRESS.search(note.rstrip()) and not note.startswith(values)
        ]
        return results

    def call(self, name: str, **parameters: Any) -> dict[str, Any]:
        """Applies a filter of the host that shapes no result, without noting its parameters."""
        return self._guard(self.meshes.apply_filter, name, **parameters) or {}

    def export(self, file: Path, parameters: Mapping[str, Any]) -> None:
        """Writes the pattern, in the format of the file's extension."""
        self._guard(self.meshes.apply_filter, EXPORT_FILTER, output_file=str(file), **parameters)

    def save(self, file: Path, **parameters: Any) -> None:
        """Saves the current mesh, in the format of the file's extension."""
        self._guard(self.meshes.save_current_mesh, str(file), **parameters)

    def _guard(self, function: Callable[..., Any], *args: Any, **parameters: Any) -> Any:
        errors = (host.pymeshlab().PyMeshLabException, RuntimeError, MemoryError)
        # A host that is not verbose swallows what is printed, and where a filter fails it goes on
        # so for all meshes to come.
        self.meshes.set_verbosity(True)
        try:
            with host.captured() as chatter:
                result = function(*args, **parameters)
            self._chatter = chatter.text
            return result
        except errors as error:
            raise DevsegError(f"{self.path}: {host_message(error)}") from error
        finally:
            self.meshes.set_verbosity(False)


def versions() -> dict[str, str]:
    """Versions of everything that shapes the result."""
    names = ("devseg", "pymeshlab", "numpy", "pillow")
    found = {name: importlib.metadata.version(name) for name in names}
    return {**found, "python": platform.python_version()}


def run(path: Path, options: RunOptions) -> dict[str, Any]:
    """Runs the whole pipeline on one file, apart, and returns what NAME.json holds.

    Raises:
        DevsegError: with nothing written.
    """
    with staged(options.out) as folder:
        return run_apart(str(path), lambda tell: _process(path, options, folder, tell))


def _process(path: Path, options: RunOptions, folder: Path, tell: Tell) -> dict[str, Any]:
    name = path.stem
    progress = Progress(name, tell=tell)
    with progress.stage("start"):
        load_plugins()
    with progress.stage(READING):
        meshes, warnings = load_mesh(path)
    mesh = meshes.current_mesh()
    size = {"vertices": mesh.vertex_number(), "faces": mesh.face_number()}
    session = Session(path, meshes)
    measures = flatten_mesh(session, options, progress)
    outputs = _write(session, options, folder / name, progress)
    result = {
        "input": path.name,
        "method": options.method.name,
        "mesh": size,
        **measures,
        "parameters": {**session.parameters, "pattern": dict(options.pattern)},
        "versions": versions(),
        "warnings": warnings + session.warnings,
        "seconds": progress.seconds,
        "outputs": outputs,
    }
    (folder / outputs["json"]).write_text(to_json(result), encoding="utf-8")
    return result


def flatten_mesh(session: Session, options: RunOptions, progress: Progress) -> dict[str, Any]:
    """Simplifies, segments, deforms, flattens and packs the mesh, as far as asked for.

    Returns:
        The measures, by stage.
    """
    found: dict[str, Any] = {}
    if options.target_faces is not None:
        with progress.stage("simplify"):
            found["simplification"] = simplify(session, options.target_faces)
    with progress.stage("segment"):
        made = session.segment(options.method.filter, **_segmentation(session, options))
    found["method_results"] = made
    if not made.get("bounds_kept", True):
        session.warnings.append(
            "no number of charts that was tried keeps the bounds on the stretch; "
            "these charts come nearest"
        )
    if options.method.deforms:
        with progress.stage("deform"):
            found["deformation"] = _deform(session)
    with progress.stage("flatten"):
        session.apply(FLATTEN_FILTER, method=FLATTENINGS[options.flatten])
    with progress.stage("measure"):
        return {
            **found,
            "segmentation": session.apply(SEGMENTATION_MEASURES),
            "parametrization": session.apply(PARAMETRIZATION_MEASURES),
        }


def simplify(session: Session, target_faces: int) -> dict[str, Any]:
    """Replaces the mesh by one of so many faces; how far apart both are, both ways.

    Deviations are shares of the diagonal of the model's box.
    """
    meshes = session.meshes
    original = meshes.current_mesh_id()
    diagonal = meshes.current_mesh().bounding_box().diagonal()
    session.call("generate_copy_of_current_mesh")
    copy = meshes.current_mesh_id()
    session.apply(
        SIMPLIFY_FILTER,
        targetfacenum=target_faces,
        preserveboundary=True,
        preservetopology=True,
        preservenormal=True,
    )
    ways = [
        session.call(DISTANCE_FILTER, sampledmesh=one, targetmesh=other, samplevert=True)
        for one, other in ((original, copy), (copy, original))
    ]
    meshes.set_current_mesh(original)
    session.call("delete_current_mesh")
    meshes.set_current_mesh(copy)
    return {
        "faces": meshes.current_mesh().face_number(),
        "mean_deviation": max(way["mean"] for way in ways) / diagonal,
        "largest_deviation": max(way["max"] for way in ways) / diagonal,
    }


def _deform(session: Session) -> dict[str, Any]:
    """Deforms the charts; the filter's results, and displacements as shares of the diagonal."""
    diagonal = session.meshes.current_mesh().bounding_box().diagonal()
    moved = session.apply(DEFORM_FILTER)
    return {
        **moved,
        "mean_share": moved["mean_displacement"] / diagonal,
        "largest_share": moved["largest_displacement"] / diagonal,
    }


def _segmentation(session: Session, options: RunOptions) -> dict[str, Any]:
    """Parameters of the segmentation filter; nobody asked for more charts than faces."""
    parameters = dict(options.segmentation)
    if "charts" in options.method.options and "charts_number" not in parameters:
        default = session.meshes.filter_parameter_values(options.method.filter)["charts_number"]
        parameters["charts_number"] = min(default, session.meshes.current_mesh().face_number())
    return parameters


def _write(session: Session, options: RunOptions, stem: Path, progress: Progress) -> dict[str, str]:
    """Writes all files but the JSON; returns the names of all, by kind."""
    from devseg.render import render_pair

    outputs = {}
    # with_suffix would cut a name such as "part.v2".
    file = stem.parent / (stem.name + ".")
    for extension in options.formats:
        target = Path(f"{file}{extension}")
        with progress.stage(extension):
            if extension in PATTERN_FORMATS:
                session.export(target, options.pattern)
            elif extension == "ply":
                session.save(
                    target,
                    binary=True,
                    save_textures=False,
                    __ca_fs__chart_id=True,
                    __ca_fs__seam_edges=True,
                )
            else:
                session.save(target, save_textures=False)
        outputs[extension] = target.name
    with progress.stage("picture"):
        target = Path(f"{file}png")
        render_pair(host.mesh_data(session.meshes.current_mesh())).save(target)
        outputs["png"] = target.name
    outputs["json"] = Path(f"{file}json").name
    return outputs
