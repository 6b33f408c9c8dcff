"""`devseg run`: one mesh in, its pattern, coloured mesh, picture and measures out."""

from __future__ import annotations

import contextlib
import platform
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import devseg
from devseg import host, scene
from devseg.apart import READING, Tell, run_apart
from devseg.errors import DevsegError, host_message
from devseg.frame import Frame
from devseg.given import Given, keep, make_charts, prepare
from devseg.lengths import shown
from devseg.load import load_mesh
from devseg.methods import EFFORTS, FLATTENINGS, Method
from devseg.notes import as_option, new_notes
from devseg.observer import heard
from devseg.outputs import plain, staged, to_json
from devseg.pattern_options import EXPORT_FILTER, TEXTURES
from devseg.pattern_writer import MESH_FORMATS, PatternWriter
from devseg.plugins import load_plugins
from devseg.progress import Progress
from devseg.requirements import installed_version
from devseg.simplify import close_holes, simplify

DEFORM_FILTER = "apply_coord_developable_charts"
SMOOTH_FILTER = "meshing_smooth_chart_seams"
COLOR_FILTER = "compute_color_by_chart_per_face"
FLATTEN_FILTER = "compute_texcoord_parametrization_charts_per_wedge"
SEGMENTATION_MEASURES = "get_segmentation_measures"
PARAMETRIZATION_MEASURES = "get_parametrization_measures"

# A finished object of another size than these was hardly meant, unless it is asked for.
SMALLEST_MM, LARGEST_MM = 20.0, 5000.0
# The export's own limit.
LEAST_MM_PER_UNIT = 1e-9
# A model that is so much longer than high may lie.
TALL = 1.1
# What rounding texture coordinates to 32 bits does to a stretch at most.
ROUNDED = 1 + 1e-5


_MOST_CHARTS = re.compile(r"--charts: expected a number from 1 to (\d+)")


@dataclass(frozen=True)
class RunOptions:
    """What `devseg run` is to do with every input.

    Attributes:
        out: folder of the outputs.
        method: segmentation method.
        segmentation: parameters of its filter that differ from the defaults.
        flatten: key of FLATTENINGS.
        formats: svg, pdf, dxf, html, png, ply, obj.
        pattern: parameters of the export filter that differ from the defaults.
        target_faces: simplify the mesh to so many faces first; None: leave it.
        deforms: whether charts are deformed until they unfold exactly; None: as the method does.
        close_holes: close holes of at most so many edges first; None: none.
        longest_mm: the longest side of the finished object; None: see pattern.
        up: axis of the file that points up, y or z; None: as its format says, else y.
        objects: names of the objects of the file to take; none: all.
        picture: whether to draw one.
        keep_texcoords: whether PLY files keep the coordinates of the file beside the new ones.
        given: charts and seams that there are, and the component to take.
        smooth_seams: whether seams become smooth curves, along which the faces are split.
        effort: of packing, key of EFFORTS.
    """

    out: Path
    method: Method
    segmentation: Mapping[str, Any]
    flatten: str
    formats: tuple[str, ...]
    pattern: Mapping[str, Any]
    target_faces: int | None = None
    longest_mm: float | None = None
    up: str | None = None
    objects: tuple[str, ...] = ()
    picture: bool = True
    keep_texcoords: bool = False
    smooth_seams: bool = False
    weld: float = 0.0  # as the parameter of all filters
    given: Given = field(default_factory=Given)
    deforms: bool | None = None
    close_holes: int | None = None
    effort: str = "normal"


class Session:
    """The filters applied to one mesh, with the parameters that were in force."""

    def __init__(
        self, path: Path, meshes: Any, warnings: Sequence[str] = (), weld: float = 0.0
    ) -> None:
        self.path = path
        self._weld = {"weld": weld} if weld else {}
        self.meshes = meshes
        self.parameters: dict[str, dict[str, Any]] = {}
        self.warnings = list(warnings)

    def apply(self, name: str, **parameters: Any) -> dict[str, Any]:
        """Applies a filter of ours and returns its results; its notes are warnings.

        Raises:
            DevsegError: with the filter's own message.
        """
        parameters = {**self._weld, **parameters}
        values = self._guard(self.meshes.filter_parameter_values, name, **parameters)
        if values:
            self.parameters[name] = values
        return self._noted(name, **parameters)

    def call(self, name: str, **parameters: Any) -> dict[str, Any]:
        """Applies a filter of the host that shapes no result, without noting its parameters."""
        return self._guard(getattr(self.meshes, name), **parameters) or {}

    def export(self, file: Path, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Writes the pattern, in the format of the file's extension; the filter's results."""
        return self._noted(EXPORT_FILTER, output_file=str(file), **self._weld, **parameters)

    def save(self, file: Path, **parameters: Any) -> None:
        """Saves the current mesh, in the format of the file's extension."""
        self._guard(self.meshes.save_current_mesh, str(file), **parameters)

    def _noted(self, name: str, **parameters: Any) -> dict[str, Any]:
        with heard() as notes:
            results: dict[str, Any] = (
                self._guard(self.meshes.apply_filter, name, **parameters) or {}
            )
        self.warnings += new_notes(notes, self.warnings)
        return results

    def _guard(self, function: Callable[..., Any], *args: Any, **parameters: Any) -> Any:
        errors = (host.pymeshlab().PyMeshLabException, RuntimeError, MemoryError)
        # A host that is not verbose swallows what is printed, and where a filter fails it goes on
        # so for all meshes to come.
        self.meshes.set_verbosity(True)
        try:
            with host.captured():
                return function(*args, **parameters)
        except errors as error:
            raise self.failure(host_message(error)) from error
        finally:
            self.meshes.set_verbosity(False)

    def failure(self, message: str) -> DevsegError:
        """A filter's message in the words of the command line."""
        return DevsegError(f"{self.path}: {as_option(message)}")


def versions() -> dict[str, str]:
    """Versions of everything that shapes the result."""
    found = {name: installed_version(name) or "none" for name in ("pymeshlab", "numpy", "pillow")}
    return {"devseg": devseg.__version__, **found, "python": platform.python_version()}


def run(path: Path, options: RunOptions) -> dict[str, Any]:
    """Runs the whole pipeline on one file, apart, and returns what NAME.json holds.

    Raises:
        DevsegError: with nothing written.
    """
    with staged(options.out) as folder:
        return run_apart(str(path), lambda tell: plain(process(path, options, folder, tell)))


def process(path: Path, options: RunOptions, folder: Path, tell: Tell) -> dict[str, Any]:
    """Runs the whole pipeline on one file, in this process, and writes into `folder`."""
    name = path.stem
    progress = Progress(name, tell=tell)
    with progress.stage("start"):
        load_plugins()
    with progress.stage(READING):
        loaded = load_mesh(path, options.objects)
        up = options.up or loaded.frame.up or "y"
        with host.captured():
            materials = prepare(path, loaded.meshes, loaded.parts, options.given)
        scene.turn(loaded.meshes, up)
    mesh = loaded.meshes.current_mesh()
    size = {"vertices": mesh.vertex_number(), "faces": mesh.face_number()}
    session = Session(path, loaded.meshes, loaded.warnings, options.weld)
    texcoords = old_texcoords(session, options)
    measures = flatten_mesh(session, options, progress)
    pattern, extents = scaled(session, options, loaded.frame, up)
    if materials:
        pattern["material_names"] = ", ".join(name.replace(",", ";") for name in materials)
    writer = PatternWriter(session, options, folder / name, progress)
    writer.write_patterns(pattern)
    scene.turn(loaded.meshes, up, back=True)
    writer.write_meshes(loaded.parts, texcoords)
    writer.outputs["json"] = f"{name}.json"
    result = {
        "input": path.name,
        "method": options.method.name if options.method.filter in session.parameters else None,
        "charts_from": options.given.charts_from,
        "mesh": size,
        "parts": scene.counted(session.meshes.current_mesh(), loaded.parts),
        "size_mm": extents,
        **measures,
        **writer.guide,
        "parameters": {**session.parameters, "pattern": pattern},
        "versions": versions(),
        "warnings": session.warnings,
        "seconds": progress.seconds,
        "outputs": writer.outputs,
    }
    (folder / writer.outputs["json"]).write_text(to_json(result), encoding="utf-8")
    return result


def flatten_mesh(session: Session, options: RunOptions, progress: Progress) -> dict[str, Any]:
    """Simplifies, segments, deforms, flattens and packs the mesh, as far as asked for.

    Returns:
        The measures, by stage.
    """
    found: dict[str, Any] = {}
    if options.close_holes is not None:
        with progress.stage("close holes"):
            close_holes(session, options.close_holes)
    if options.target_faces is not None:
        with progress.stage("simplify"):
            textured = options.pattern.get("texture") == TEXTURES["auto"]
            found["simplification"] = simplify(session, options.target_faces, textured)
    with progress.stage("segment"):
        made = _make_charts(session, options)
    found["method_results"] = made
    if not made.get("bounds_kept", True) and not made.get("charts_above_bound_number"):
        session.warnings.append(
            "the bounds on the stretch of the whole map are not kept; these charts come nearest"
        )
    kept = None  # the mesh before, where smooth seams may break bounds
    if options.smooth_seams:
        with progress.stage("smooth"):
            if _bounds(options) and made.get("bounds_kept", True):
                kept = _copy(session)
            found["smoothing"] = session.apply(SMOOTH_FILTER, **_smoothing(session, options))
    if options.method.deforms if options.deforms is None else options.deforms:
        with progress.stage("deform"):
            found["deformation"] = _deform(session)
    measures = _flatten(session, options, progress)
    flat = measures["parametrization"]
    if kept is not None and any(flat[name] > most for name, most in _bounds(options).items()):
        session.warnings.append(
            "smooth seams would break the bounds on the stretch: seams stay on edges"
        )
        del found["smoothing"]
        session.meshes.set_current_mesh(kept)
        measures = _flatten(session, options, progress)
    tell_charts_above(session, options, made, measures)
    return {**found, **measures}


def tell_charts_above(
    session: Session, options: RunOptions, made: dict[str, Any], measures: dict[str, Any]
) -> None:
    """Warns of charts above their bound that no filter has told of: most are parts of others."""
    bound = session.parameters.get(options.method.filter, {}).get("max_chart_l2_stretch")
    if not bound:
        return
    stretch = measures["parametrization"]["chart_l2_stretch"]
    above = sum(l2 > bound * ROUNDED for l2 in stretch)
    names = ("charts_above_bound_number", "rough_charts_number", "thin_charts_number")
    told = int(sum({**made, **measures["flattening"]}.get(name, 0) for name in names))
    if above > told:
        session.warnings.append(
            f"{above - told} charts are above their bound of stretch since the mesh was flattened: "
            "parts of charts that lay on themselves and were cut apart"
        )


def _make_charts(session: Session, options: RunOptions) -> dict[str, Any]:
    """Makes charts of what there is, by the method, or both; the results of the last filter."""
    made = make_charts(session, options.given) if options.given.charts_from else {}
    kept = keep(session, options.given)
    if options.given.charts_from and kept is None:
        return made
    parameters = {**options.segmentation, **({"keep": kept} if kept else {})}
    return segment(session, options.method, parameters)


def _flatten(session: Session, options: RunOptions, progress: Progress) -> dict[str, Any]:
    """Flattens the charts; measures of them, by kind."""
    kept = {"keep": "Seams"} if options.given.has_seams else {}
    with progress.stage("flatten"):
        method, effort = FLATTENINGS[options.flatten], EFFORTS[options.effort]
        flat = session.apply(FLATTEN_FILTER, method=method, effort=effort, **kept)
        # Faces were split, whose parts are in other charts; or charts came apart, and parts are at
        # others now.
        if options.smooth_seams or flat["overlap_cuts_number"]:
            session.call(COLOR_FILTER)
    with progress.stage("measure"):
        return {
            "flattening": flat,
            "segmentation": session.apply(SEGMENTATION_MEASURES),
            "parametrization": session.apply(PARAMETRIZATION_MEASURES),
        }


def _smoothing(session: Session, options: RunOptions) -> dict[str, Any]:
    """The bounds on each chart that the segmentation kept, and mirror images where it made some."""
    used = session.parameters.get(options.method.filter, {})
    bounds = {name: used[name] for name in ("max_chart_l2_stretch", "max_strain") if used.get(name)}
    return {**bounds, **({"symmetric": True} if options.method.name == "plush" else {})}


def _bounds(options: RunOptions) -> dict[str, float]:
    """Bounds on the stretch that the segmentation was given, by the name of the measure."""
    names = {"max_l2_stretch": "l2_stretch", "max_linf_stretch": "linf_stretch"}
    given = options.segmentation
    return {measure: given[bound] for bound, measure in names.items() if given.get(bound)}


def _copy(session: Session) -> int:
    """Copies the current mesh with its attributes, which the host's own copy lacks; its number."""
    meshes = session.meshes
    original = meshes.current_mesh()
    number = meshes.current_mesh_id()
    values = {}
    for name in ("chart_id", "seam_edges", scene.PART_ATTRIBUTE):
        with contextlib.suppress(host.pymeshlab().PyMeshLabException):
            values[name] = original.face_custom_scalar_attribute_array(name)
    session.call("generate_copy_of_current_mesh")
    copy = meshes.current_mesh_id()
    for name, of_faces in values.items():
        meshes.current_mesh().add_face_custom_scalar_attribute(of_faces, name)
    meshes.set_current_mesh(number)
    return copy


def _deform(session: Session) -> dict[str, Any]:
    """Deforms the charts; the filter's results, and displacements as shares of the diagonal."""
    diagonal = session.meshes.current_mesh().bounding_box().diagonal()
    moved = session.apply(DEFORM_FILTER)
    session.call(COLOR_FILTER)  # parts hang on other charts now
    return {
        **moved,
        "mean_share": moved["mean_displacement"] / diagonal,
        "largest_share": moved["largest_displacement"] / diagonal,
    }


def segment(
    session: Session, method: Method, given: Mapping[str, Any], charts: int | None = None
) -> dict[str, Any]:
    """Applies a method and returns its results.

    Args:
        session: with the mesh.
        method: the method.
        given: the parameters that somebody asked for.
        charts: a number of charts that nobody asked for; None: the filter's own. A mesh of fewer
            faces gets as many charts as faces.
    """
    parameters = dict(given)
    if charts is not None and "charts" in method.options:
        parameters.setdefault("charts_number", charts)
    try:
        return session.apply(method.filter, **parameters)
    except DevsegError as error:
        # Only the filter knows how many faces are left of a mesh with faults.
        most = _MOST_CHARTS.search(str(error))
        if most is None or "charts_number" in given:
            raise
        return session.apply(method.filter, **{**parameters, "charts_number": int(most[1])})


def scaled(
    session: Session, options: RunOptions, frame: Frame, up: str
) -> tuple[dict[str, Any], list[float]]:
    """The parameters of the export, with a scale, and the size of the finished object.

    The size is along x, y and z of the file, in mm. What may surprise becomes a warning.
    """
    mesh = session.meshes.current_mesh()
    corners = mesh.vertex_matrix()[mesh.face_matrix().ravel()]
    extents = [float(e) for e in corners.max(axis=0) - corners.min(axis=0)]
    pattern = dict(options.pattern)
    given = True
    if "height_mm" in pattern:
        mm = pattern["height_mm"] / extents[1] if extents[1] else 0.0
        if options.up is None and frame.up is None and TALL * extents[1] < max(extents):
            session.warnings.append(
                f"the height is along y, where the model measures {extents[1]:.4g} of "
                f"{max(extents):.4g} units; give --up z if z points up in it, else --up y"
            )
    elif options.longest_mm is not None:
        mm = pattern["mm_per_unit"] = options.longest_mm / max(extents)
        if mm < LEAST_MM_PER_UNIT:
            raise DevsegError(
                f"{session.path}: expected a model that is smaller, found {max(extents):.3g} "
                "units; give a larger --longest-mm, or repair the file"
            )
    else:
        given = "mm_per_unit" in pattern
        mm = pattern.setdefault("mm_per_unit", frame.mm_per_unit or 1.0)
    size = [mm * extents[k] for k in ((0, 1, 2) if up == "y" else (0, 2, 1))]
    if not given and not SMALLEST_MM <= max(size) <= LARGEST_MM:
        unit = "a unit of the file is" if frame.mm_per_unit else "without a scale a unit is"
        session.warnings.append(
            f"{unit} {mm:g} mm, so that the finished object measures "
            f"{shown(size)}; give its size by --height-mm, --longest-mm or "
            "--mm-per-unit (1000 for a model in metres)"
        )
    return pattern, size


def old_texcoords(session: Session, options: RunOptions) -> Any:
    """The texture coordinates of the file, #F by 6; None where they are not kept.

    One warning says that they are replaced.
    """
    mesh = session.meshes.current_mesh()
    if not mesh.has_wedge_tex_coord() and mesh.has_vertex_tex_coord():
        session.call("compute_texcoord_transfer_vertex_to_wedge")
    if not mesh.has_wedge_tex_coord():
        return None
    coordinates = mesh.wedge_tex_coord_matrix().reshape(-1, 6)
    if not coordinates.any():
        return None
    # The host takes the last one for images that it cannot read.
    textures = ", ".join(Path(name).name for name in mesh.textures() if name != "dummy.png")
    lost = f"; its textures ({textures}) do not fit the new ones" if textures else ""
    kept = options.keep_texcoords
    advice = "PLY has them as texcoord_before" if kept else "--keep-texcoords keeps them in PLY"
    if set(MESH_FORMATS) & set(options.formats):
        session.warnings.append(f"the texture coordinates of the file are replaced{lost}; {advice}")
    return coordinates if kept else None
