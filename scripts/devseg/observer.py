"""Progress of filters, a way to cancel them, and their notes, which the host does not pass on."""

from __future__ import annotations

import contextlib
import ctypes
import os
from collections.abc import Callable, Iterator
from typing import Any

from devseg import host
from devseg.errors import DevsegError
from devseg.plugins import plugin_paths

# Called with the share of the work that is done, from 0 to 1, and the name of what runs; the work
# is cancelled where it returns False. Hosts are asked up to fifty times a second.
ProgressFunction = Callable[[float, str], Any]

_Observer = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_double, ctypes.c_char_p)
_Listener = ctypes.CFUNCTYPE(None, ctypes.c_char_p)


class Observation:
    """Passes the progress of filters on, which are shares of the whole work.

    Attributes:
        cancelled: whether the function returned False.
        error: what the function raised; the work ends as if it were cancelled.
    """

    def __init__(self, function: ProgressFunction | None) -> None:
        self.cancelled = False
        self.error: BaseException | None = None
        self._function = function
        self._begin = 0.0
        self._share = 1.0

    def part(self, begin: float, share: float) -> None:
        """The next filter is so much of the whole, from `begin` on."""
        self._begin, self._share = begin, share

    def __call__(self, fraction: float, part: bytes) -> int:
        """0 to cancel, as the plugin asks."""
        try:
            if self._function is not None:
                share = self._begin + self._share * fraction
                with host.uncaptured():
                    self.cancelled = self._function(share, part.decode()) is False
        except BaseException as error:  # a signal as well: nobody above could catch it
            self.error = error
        return int(not self.cancelled and self.error is None)


@contextlib.contextmanager
def observed(observation: Observation) -> Iterator[None]:
    """Filters that this thread runs in the block report to the observation."""
    set_observer = _plugin().devseg_observe
    set_observer.argtypes = [_Observer]
    set_observer.restype = None
    # Filters keep it until they end, which is within the block.
    callback = _Observer(observation)
    set_observer(callback)
    try:
        yield
    finally:
        set_observer(_Observer())


@contextlib.contextmanager
def heard() -> Iterator[list[str]]:
    """The notes of the filters that this thread runs in the block, in order.

    The host prints them to its log, but none any more once a filter has failed in this process.
    """
    notes: list[str] = []
    set_listener = _plugin().devseg_listen
    set_listener.argtypes = [_Listener]
    set_listener.restype = None
    listener = _Listener(lambda note: notes.append(note.decode(errors="replace")))
    set_listener(listener)
    try:
        yield notes
    finally:
        set_listener(_Listener())


def _plugin() -> ctypes.CDLL:
    """The filter plugin that this process has loaded."""
    path = plugin_paths()[0]
    try:
        return ctypes.CDLL(str(path), mode=os.RTLD_NOLOAD | os.RTLD_NOW)
    except OSError as error:
        raise DevsegError(
            f"expected the plugin {path} in pymeshlab, found that another one was loaded before; "
            "load it by devseg.load_plugins()"
        ) from error
