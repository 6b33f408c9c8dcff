"""Seconds per stage, shown while they pass where somebody is looking."""

from __future__ import annotations

import contextlib
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


# Back to the line's start, and erase what was there.
CLEAR_LINE = "\r\x1b[K"


class Progress:
    """Measures the stages of one input.

    Attributes:
        seconds: of every stage that has ended, in order.
    """

    def __init__(
        self, name: str, show: bool | None = None, tell: Callable[[str], None] | None = None
    ) -> None:
        self.seconds: dict[str, float] = {}
        self._name = name
        self._tell = tell
        self._show = sys.stderr.isatty() if show is None else show

    @contextlib.contextmanager
    def stage(self, stage: str) -> Iterator[None]:
        """Times a block; on a terminal one line tells what runs, then how long it took."""
        if self._tell:
            self._tell(stage)
        self._write(f"{self._name}: {stage} ...")
        start = time.perf_counter()
        try:
            yield
        except BaseException:
            # The line makes room for the error message.
            self._write("")
            raise
        self.seconds[stage] = round(time.perf_counter() - start, 3)
        self._write(f"{self._name}: {stage} {self.seconds[stage]:.1f} s\n")

    def _write(self, text: str) -> None:
        if self._show:
            sys.stderr.write(CLEAR_LINE + text)
            sys.stderr.flush()
