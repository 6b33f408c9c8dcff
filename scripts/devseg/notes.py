"""What filters say, in the words of the command line: their notes and their errors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from devseg.methods import OPTION_OF
from devseg.pattern_options import OPTION_OF as PATTERN_OPTION_OF

# What notes advise users of a window: ('Remove Duplicate Faces' drops such faces).
_HINT = re.compile(r" \('[A-Z][^()]*\)$")
# What errors advise, and what the command line has instead.
ADVICE = (
    (
        "use more charts, set 'adjust_slits', or set 'keep_unfinished' to get the best state",
        "give more --charts, fewer --target-faces, or another --method",
    ),
    ("give mm_per_unit instead", "give --mm-per-unit or --up instead"),
    ("give a smaller mm_per_unit or height_mm", "give a smaller --mm-per-unit or --height-mm"),
)
_TURNED = re.compile(r"(; patterns are|: read) turned over$")


def new_notes(notes: Iterable[str], told: Sequence[str]) -> list[str]:
    """The notes of a filter, without those told before.

    Every filter that reads the mesh tells of its faults again, also where it has been split since
    then and has more of them.

    Args:
        notes: of the filter.
        told: the notes of the filters before.
    """
    known = {_shape(note) for note in told}
    found: list[str] = []
    for told_now in notes:
        note = _HINT.sub("", told_now.rstrip())
        if _shape(note) not in known:
            known.add(_shape(note))
            found.append(note)
    return found


def _shape(note: str) -> str:
    """A note without its numbers, and without what one filter does and another says."""
    return re.sub(r"\d+", "#", _TURNED.sub("", note))


def as_option(message: str) -> str:
    """An error of a filter, with the options of the command line in place of its parameters."""
    for advice, ours in ADVICE:
        message = message.replace(advice, ours)
    name, colon, rest = message.partition(": ")
    option = {**PATTERN_OPTION_OF, **OPTION_OF}.get(name)
    return f"{option}: {rest}" if colon and option else message
