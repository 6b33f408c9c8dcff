"""The files of a pattern: drawings and markers, the picture, and meshes with their charts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg import cloth, guide, host, ply, scene
from devseg.given import MATERIAL_ATTRIBUTE
from devseg.obj_parts import Part
from devseg.obj_writer import write_obj
from devseg.pattern_options import PATTERN_FORMATS
from devseg.progress import Progress

if TYPE_CHECKING:
    from devseg.pipeline import RunOptions, Session

MESH_FORMATS = ("ply", "obj")

# Higher levels take several times as long for a tenth of the size.
PNG_COMPRESSION = 1

# What follows NAME in pattern files of pixels.
PAGE = "_page"


def pages(target: Path, results: Mapping[str, Any]) -> list[Path]:
    """The files of a pattern of pixels: one for each page."""
    count = int(results["pages_number"])
    if count == 1:
        return [target]
    return [target.with_name(f"{target.stem}_{i + 1}{target.suffix}") for i in range(count)]


class PatternWriter:
    """Writes all files but the JSON, and keeps their names by kind."""

    def __init__(
        self, session: Session, options: RunOptions, stem: Path, progress: Progress
    ) -> None:
        self.session = session
        self.options = options
        self.stem = stem
        self.progress = progress
        self.outputs: dict[str, str] = {}
        self.guide: dict[str, Any] = {}

    def _target(self, extension: str, suffix: str = "") -> Path:
        # with_suffix would cut a name such as "part.v2".
        return self.stem.parent / f"{self.stem.name}{suffix}.{extension}"

    def write_patterns(self, pattern: Mapping[str, Any]) -> None:
        """What shows the mesh upright: patterns and the picture."""
        plain, marker = cloth.split(pattern)
        files = list(cloth.written(plain))
        for extension in self._formats(PATTERN_FORMATS):
            for suffix, parameters in files:
                # NAME.png is the picture of the mesh.
                own = PAGE + suffix if extension == "png" else suffix
                target = self._target(extension, own)
                results = self.session.export(target, parameters)
                if extension == "png":
                    for page in pages(target, results):
                        self.outputs[page.stem.removeprefix(f"{self.stem.name}_")] = page.name
                elif suffix:
                    self.outputs[f"{extension}{suffix}"] = target.name
            names = cloth.fabrics(plain)
            self.guide = {"assembly": guide.assembly(results), "needs": guide.needs(results)}
            if names:
                self.guide["materials"] = cloth.materials(results, names)
            if "material" in plain:
                self.guide["cloth"] = cloth.strains(results, plain["material"])
        for extension in self.options.formats:
            if marker and extension in cloth.MARKER_FORMATS:
                with self.progress.stage(f"marker {extension}"):
                    target = self._target(extension, "_marker")
                    results = self.session.export(target, marker)
                self.guide["marker"] = cloth.marker(results, cloth.fabrics(marker))
                self.outputs[f"marker_{extension}"] = target.name
        if self.options.picture:
            with self.progress.stage("picture"):
                from devseg.render import render_pair

                data = host.mesh_data(self.session.meshes.current_mesh())
                render_pair(data).save(self._target("png"), compress_level=PNG_COMPRESSION)
                self.outputs["png"] = self._target("png").name

    def write_meshes(self, parts: Sequence[Part], texcoords: Any) -> None:
        """What has the frame of the file."""
        mesh = self.session.meshes.current_mesh()
        for extension in self._formats(MESH_FORMATS):
            target = self._target(extension)
            if extension == "obj":
                ids = scene.part_ids(mesh, parts)
                write_obj(target, mesh, parts, ids, self.session.path)
                continue
            attributes = ["chart_id", "seam_edges"]
            attributes += [scene.PART_ATTRIBUTE] if len(parts) > 1 else []
            attributes += [MATERIAL_ATTRIBUTE] if self.options.given.material_borders else []
            self.session.save(
                target,
                binary=True,
                save_textures=False,
                **{f"__ca_fs__{name}": True for name in attributes},
            )
            ply.finish(target, scene.comments(parts), texcoords)

    def _formats(self, known: Sequence[str]) -> Iterator[str]:
        """Those of the formats that are asked for, each as a stage of its own."""
        for extension in self.options.formats:
            if extension in known:
                with self.progress.stage(extension):
                    yield extension
                if (
                    extension != "png" and self._target(extension).exists()
                ):  # else one for each size
                    self.outputs[extension] = self._target(extension).name
