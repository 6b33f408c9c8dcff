"""What filters say, in the words of the command line: their notes and their errors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from devseg.methods import OPTION_OF
from devseg.pattern_options import OPTION_OF as PATTERN_OPTION_OF

# What the host prints for each line of a filter's log, and for its progress.
_LOGGED = re.compile(r"^LOG: \d+ (.*)$", re.MULTILINE)
_PROGRESS = re.compile(r"\[ +\d+% \]$")
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


def new_notes(chatter: str, results: Iterable[str], told: Sequence[str]) -> list[str]:
    """The notes that a filter has left in what the host printed, without those told before.

    Every filter that reads the mesh tells of its faults again, also where it has been split since
    then and has more of them.

    Args:
        chatter: what the host printed.
        results: names of the filter's results, which the host logs as well.
        told: the notes of the filters before.
    """
    values = tuple(f"{result}: " for result in results)
    known = {_shape(note) for note in told}
    found: list[str] = []
    for logged in _LOGGED.findall(chatter):
        note = _HINT.sub("", logged.rstrip())
        if _PROGRESS.search(note) or note.startswith(values) or _shape(note) in known:
            continue
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
