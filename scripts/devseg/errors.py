"""The one exception that users of the package see, and how a host's error becomes one."""

from __future__ import annotations

import re


class DevsegError(Exception):
    """A failure that is told in one line: what was expected, what was found, what to do."""


class Cancelled(DevsegError):
    """The caller's progress function returned False; nothing has changed."""


def one_line(text: str) -> str:
    """Text without line breaks and repeated blanks."""
    return re.sub(r"\s+", " ", text).strip()


def host_message(error: BaseException) -> str:
    """The part of an error of the host that concerns the user.

    pymeshlab puts "Failed to apply filter: NAME" and "Details:" before a plugin's own message.
    """
    if isinstance(error, MemoryError):
        return "not enough memory; close other programs or simplify the mesh"
    text = str(error)
    for marker in ("Error details:", "Details:"):
        if marker in text:
            text = text.split(marker, 1)[1]
    return one_line(text) or type(error).__name__
