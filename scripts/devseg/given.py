"""Charts that the user has: texture islands, materials, components, numbers of a file."""

from __future__ import annotations

import argparse
import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg import host, ply, scene
from devseg.errors import DevsegError
from devseg.obj_parts import Part

if TYPE_CHECKING:
    from devseg.pipeline import Session

EDGES_ATTRIBUTE = "seam_edges"
CHARTS_ATTRIBUTE = "chart_id"
MATERIAL_ATTRIBUTE = "material_id"
COMPONENT_ATTRIBUTE = "component_of_file"
TEXTURE_FILTER = "compute_charts_from_texcoord_per_face"
MATERIALS_FILTER = "compute_charts_from_materials_per_face"
DISKS_FILTER = "compute_seams_charts_to_disks_per_edge"
COLOR_FILTER = "compute_color_by_chart_per_face"
SOURCES = ("uv", "materials", "components", "attribute")
MATERIAL_SOURCES = ("colors", "materials", "attribute")


@dataclass(frozen=True)
class Given:
    """What the user has chosen.

    Attributes:
        charts_from: one of SOURCES, or a file with a number for each face; None: a method.
        keep_seams: whether a method goes on within the seams that there are.
        component: the number of the component to take, the largest is 1; None: all.
        material_borders: one of MATERIAL_SOURCES: a method goes on within their borders; None.
    """

    charts_from: str | None = None
    keep_seams: bool = False
    component: int | None = None
    material_borders: str | None = None

    @property
    def has_seams(self) -> bool:
        """Whether there are seams that somebody has chosen."""
        return bool(self.charts_from or self.keep_seams or self.material_borders)


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options of `devseg run` for charts that there are."""
    group = parser.add_argument_group("charts and seams that you have")
    group.add_argument(
        "--charts-from",
        metavar="WHAT",
        help="uv: the islands of the file; materials; components; attribute: chart_id of a PLY "
        "file; or a text file with a number for each face (-1: the method makes charts there)",
    )
    group.add_argument(
        "--keep-seams",
        action="store_true",
        help="the method cuts further, and takes no seam of the file or of --charts-from away",
    )
    group.add_argument(
        "--material-borders",
        choices=MATERIAL_SOURCES,
        help="borders of materials are seams, each piece is of one material, and each material "
        "has a marker of its own: face colors, materials of the file, or attribute: material_id "
        "of a PLY file",
    )


def check(args: argparse.Namespace, parser: argparse.ArgumentParser) -> Given:
    """The options as they were given; parser reports wrong usage."""
    if (args.charts_from or args.keep_seams) and args.target_faces:
        parser.error("--charts-from and --keep-seams need the faces of the file: no --target-faces")
    if args.material_borders and (args.charts_from or args.keep_seams or args.target_faces):
        parser.error(
            "--material-borders needs the faces of the file and charts that the method makes: no "
            "--charts-from, --keep-seams or --target-faces"
        )
    return Given(args.charts_from, args.keep_seams, args.component, args.material_borders)


def prepare(path: Path, meshes: Any, parts: Sequence[Part], given: Given) -> list[str]:
    """Gives the faces of a mesh that was just loaded what the charts are made from.

    Returns:
        The names of the materials, where the faces have numbers of several ones now.

    Raises:
        DevsegError: where the file has no such thing.
    """
    mesh = meshes.current_mesh()
    source = given.charts_from
    restored = ply.restore_attributes(mesh, path) if source in (None, "attribute") else []
    if source == "attribute" and CHARTS_ATTRIBUTE not in restored:
        raise DevsegError(
            f"{path}: expected a binary PLY file whose faces have a chart_id, found none; "
            "'devseg run' writes such files"
        )
    if given.keep_seams and source is None and not (restored or mesh.has_wedge_tex_coord()):
        raise DevsegError(
            f"{path}: expected seams to keep, found neither chart_id nor texture coordinates; "
            "give --charts-from"
        )
    names: list[str] = []
    if source == "materials":
        names = _number_materials(mesh, parts)
    elif source is not None and source not in SOURCES:
        mesh.add_face_custom_scalar_attribute(
            _read_numbers(Path(source), mesh.face_number()), CHARTS_ATTRIBUTE
        )
    if given.component is not None:
        choose_component(path, meshes, given.component)
        mesh = meshes.current_mesh()
    if given.material_borders:
        names = _part_materials(path, mesh, parts, given.material_borders)
    return names


def _number_materials(mesh: Any, parts: Sequence[Part]) -> list[str]:
    import numpy as np

    names = sorted({part.material for part in parts})
    if len(names) < 2:
        return []
    number = np.array([float(names.index(part.material)) for part in parts])
    mesh.add_face_custom_scalar_attribute(number[scene.part_ids(mesh, parts)], MATERIAL_ATTRIBUTE)
    return names


def _number_colors(mesh: Any) -> list[str]:
    import numpy as np

    if not mesh.has_face_color():
        return []
    levels = np.rint(255 * mesh.face_color_matrix()[:, :3]).astype(int)
    colors, number = np.unique(levels, axis=0, return_inverse=True)
    mesh.add_face_custom_scalar_attribute(number.reshape(-1).astype(float), MATERIAL_ATTRIBUTE)
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in colors]


def _part_materials(path: Path, mesh: Any, parts: Sequence[Part], source: str) -> list[str]:
    """Makes charts of what is of one material, as numbers; the names of the materials."""
    import numpy as np

    if source == "attribute":
        ply.restore_attributes(mesh, path, (MATERIAL_ATTRIBUTE,))
        names = []
    else:
        names = _number_colors(mesh) if source == "colors" else _number_materials(mesh, parts)
    numbers = np.zeros(0)
    with contextlib.suppress(host.pymeshlab().PyMeshLabException):
        numbers = mesh.face_custom_scalar_attribute_array(MATERIAL_ATTRIBUTE)
    found = np.unique(numbers)
    if len(found) < 2:
        raise DevsegError(
            f"{path}: expected faces of several materials ({source}), found "
            f"{'one' if len(found) else 'none'}; leave --material-borders out"
        )
    for name, values in (
        (CHARTS_ATTRIBUTE, np.searchsorted(found, numbers)),
        (EDGES_ATTRIBUTE, np.zeros(len(numbers))),
    ):
        mesh.add_face_custom_scalar_attribute(values.astype(float), name)
    return names or [f"material {number:g}" for number in found]


def _read_numbers(path: Path, faces: int) -> Any:
    import numpy as np

    if not path.is_file():
        raise DevsegError(
            f"--charts-from: expected one of {', '.join(SOURCES)} or a file, found '{path}'"
        )
    words = path.read_text(encoding="utf-8", errors="replace").split()
    if len(words) != faces:
        raise DevsegError(
            f"{path}: expected a number for each of {faces} triangles, found {len(words)} words"
        )
    try:
        return np.array([float(int(word)) for word in words])
    except ValueError as error:
        raise DevsegError(f"{path}: expected whole numbers, found other words ({error})") from error


def components(vertices: Any, faces: Any) -> Any:
    """For each face its component, #F: the largest is 0. Vertices at one place are one."""
    import numpy as np

    _, place = np.unique(vertices, axis=0, return_inverse=True)
    corners = place.reshape(-1)[faces]
    # Every round hands the lowest number on to all that touch, and jumps along the way.
    label = np.arange(int(corners.max()) + 1)
    while True:
        lowest = label[corners].min(axis=1)
        new = label.copy()
        np.minimum.at(new, corners.ravel(), np.repeat(lowest, 3))
        new = new[new]
        if np.array_equal(new, label):
            break
        label = new
    _, component, counts = np.unique(label[corners[:, 0]], return_inverse=True, return_counts=True)
    rank = np.empty(len(counts), dtype=np.int64)
    rank[np.argsort(-counts, kind="stable")] = np.arange(len(counts))
    return rank[component.reshape(-1)]


def choose_component(path: Path, meshes: Any, number: int) -> None:
    """Removes all but one of the connected components.

    Raises:
        DevsegError: where there are not so many.
    """
    mesh = meshes.current_mesh()
    component = components(mesh.vertex_matrix(), mesh.face_matrix())
    count = int(component.max()) + 1
    if number > count:
        raise DevsegError(
            f"{path}: expected a --component from 1 to {count}, the largest first, found {number}"
        )
    mesh.add_face_custom_scalar_attribute(component.astype(float), COMPONENT_ATTRIBUTE)
    meshes.compute_selection_by_condition_per_face(
        condselect=f"({COMPONENT_ATTRIBUTE} != {number - 1})"
    )
    if mesh.selected_face_number():
        meshes.meshing_remove_selected_faces()
        meshes.meshing_remove_unreferenced_vertices()


def keep(session: Session, given: Given) -> str | None:
    """The value of the segmentation's parameter `keep`; None where it begins anew, or is not run.

    Faces of --charts-from without a chart are left to the method.
    """
    if given.keep_seams or given.material_borders:
        return "Seams"
    if given.charts_from in (None, "uv", "materials", "components"):
        return None
    charts = session.meshes.current_mesh().face_custom_scalar_attribute_array(CHARTS_ATTRIBUTE)
    return "Charts" if (charts < 0).any() else None


def make_charts(session: Session, given: Given) -> dict[str, Any]:
    """Makes the charts, each a disk with a colour; the results of the filter that made them."""
    if given.charts_from == "uv":
        return session.apply(TEXTURE_FILTER)
    if given.charts_from in ("materials", "components"):
        return session.apply(MATERIALS_FILTER, source=given.charts_from.capitalize())
    if keep(session, given) == "Charts":
        return {}
    made = session.apply(DISKS_FILTER, cut_tips=False)
    session.apply(COLOR_FILTER)
    return made
