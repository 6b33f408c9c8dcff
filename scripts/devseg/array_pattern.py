"""Patterns of an atlas of arrays: files, measures and pieces. See arrays.py for conventions."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg import scene
from devseg.array_session import ArraySession, array_session, known_options, known_word
from devseg.array_types import Atlas, Pieces
from devseg.errors import DevsegError
from devseg.frame import UPRIGHT
from devseg.outputs import staged
from devseg.pattern_options import CORNERS, DXF_KINDS, EXPORT_FILTER, PATTERN_FORMATS, PRESETS

if TYPE_CHECKING:
    from devseg.observer import ProgressFunction

PIECES_FILTER = "generate_pattern_pieces"
PATTERN_MEASURES = "get_pattern_measures"

# Words of the command line for values of the export filter's parameters.
_WORDS = {"preset": PRESETS, "corner_style": CORNERS, "dxf_kind": DXF_KINDS}


@dataclass(frozen=True, eq=False)
class Pattern:
    """A pattern that can be saved and measured.

    Attributes:
        atlas: whose pattern it is.
        up: axis of the model that points up, y or z.
        parameters: of the export filter that differ from the defaults.
    """

    atlas: Atlas
    up: str
    parameters: Mapping[str, Any]

    def save(
        self, path: str | Path, *, progress: ProgressFunction | None = None
    ) -> tuple[str, ...]:
        """Writes the pattern as SVG, PDF or DXF, whole or not at all.

        Returns:
            What the export worked around, or what may surprise.

        Raises:
            DevsegError: for another extension, and for a value out of its range.
            Cancelled: where `progress` returned False.
        """
        target = Path(path)
        if target.suffix.lower()[1:] not in PATTERN_FORMATS:
            wanted = ", ".join(f".{kind}" for kind in PATTERN_FORMATS)
            raise DevsegError(f"{target}: expected a file that ends in one of {wanted}")
        with staged(target.parent) as folder, self._session(progress) as session:
            session.export(folder / target.name, self.parameters)
            return tuple(session.warnings)

    def measures(self) -> dict[str, Any]:
        """Results of `get_pattern_measures`: pieces, seams, mismatch and strain, in millimetres."""
        with self._session(None) as session:
            return session.apply(PATTERN_MEASURES, **self._shared(session, PATTERN_MEASURES))

    def pieces(self) -> Pieces:
        """The pieces as a flat mesh in millimetres."""
        with self._session(None) as session:
            session.apply(PIECES_FILTER, **self._shared(session, PIECES_FILTER))
            mesh = session.meshes.current_mesh()
            return Pieces(
                mesh.vertex_matrix(),
                mesh.face_matrix(),
                mesh.face_custom_scalar_attribute_array("piece_id").astype("int64"),
            )

    @contextlib.contextmanager
    def _session(self, progress: ProgressFunction | None) -> Iterator[ArraySession]:
        """With the atlas upright, as patterns are drawn."""
        with array_session(progress) as session:
            session.add_atlas(self.atlas)
            scene.turn(session.meshes, self.up)
            yield session

    def _shared(self, session: ArraySession, filter_name: str) -> dict[str, Any]:
        """The parameters that another filter has as well."""
        known = session.meshes.filter_parameter_values(filter_name)
        return {name: value for name, value in self.parameters.items() if name in known}


def pattern(
    atlas: Atlas, *, longest_mm: float | None = None, up: str = "y", **options: Any
) -> Pattern:
    """A pattern of an atlas, true to scale.

    Args:
        atlas: of `unwrap`.
        longest_mm: longest side of the finished object in millimetres, whatever is up.
        up: axis of the model that points up, y or z; it counts for `height_mm` and for covers.
        options: parameters of `export_pattern`, such as `height_mm=250`, `preset="sewing"`,
            `page="a4"`, `seam_allowance_mm=6`. Without a size a unit is a millimetre.

    Raises:
        DevsegError: for a word or a value that the filter does not know.
    """
    import numpy as np

    if up not in UPRIGHT:
        raise DevsegError(f"up: expected y or z, found {up!r}")
    given = dict(options)
    for name, words in _WORDS.items():
        if name in given:
            given[name] = known_word(name, str(given[name]).lower(), words)
    if longest_mm is not None:
        if {"height_mm", "mm_per_unit"} & given.keys():
            raise DevsegError("longest_mm: expected one size, found another beside it")
        extents = np.ptp(atlas.vertices[np.unique(atlas.faces)], axis=0)
        if not longest_mm > 0:
            raise DevsegError(f"longest_mm: expected a length above 0, found {longest_mm!r}")
        given["mm_per_unit"] = longest_mm / float(extents.max())
    with array_session(None) as session:
        session.add_atlas(atlas)
        given = known_options(EXPORT_FILTER, session.meshes, given, ("output_file",))
    return Pattern(atlas, up, given)
