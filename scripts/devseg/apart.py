"""Work in a child process, whose end is told, whatever ends it.

Readers of the host trust the files that they read, and a file that lies takes the process with it.
docs/decisions/0038 says why the whole work on a mesh happens here, and why the child is forked.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import pickle
import re
import resource
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Generic, TypeVar, cast

from devseg import host
from devseg.errors import DevsegError, one_line
from devseg.progress import CLEAR_LINE

T = TypeVar("T")

# Processor seconds that reading may take, and more for each megabyte of a file. Reading takes a
# hundredth of it, unless a reader follows a loop in a damaged file.
READING_SECONDS = 30.0
READING_SECONDS_PER_MB = 2.0

# Tells the parent which stage the child is in.
Tell = Callable[[str], None]

# The stage in which the host reads the file.
READING = "load"

# On a busy machine a process waits: it is over its limit of time when it has also worked so long,
# or has waited for so many times as long.
BUSY = 5
# Between two looks at what a process uses: a fifth of a GB of memory can be filled in it.
_LOOK_SECONDS = 0.05

_PR_SET_PDEATHSIG = 1


class Crashed(DevsegError):
    """The process ended without an answer."""


class OverTime(DevsegError):
    """The process took longer than its limit and was ended."""


class OverMemory(DevsegError):
    """The process took more memory than its limit and was ended."""


@dataclass(frozen=True)
class Limits:
    """What a piece of work may take.

    Attributes:
        seconds: of processor time and of the clock, whichever is less; None: no limit. A process
            that waits for others may take BUSY times as many by the clock.
        memory: bytes of physical memory; None: no limit.
    """

    seconds: float | None = None
    memory: int | None = None


NO_LIMITS = Limits()


@dataclass(frozen=True)
class Ended(Generic[T]):
    """How a piece of work ended.

    Attributes:
        result: what it returned; None after an error.
        error: what it raised, or how its process ended; None after success.
        seconds: by the clock.
        cpu_seconds: of processor time.
        memory: the most bytes of physical memory.
    """

    result: T | None
    error: BaseException | None
    seconds: float
    cpu_seconds: float
    memory: int


def run_apart(what: str, work: Callable[[Tell], T]) -> T:
    """Does `work` in a child process and returns what it returned, or raises what it raised.

    Args:
        what: the work's input, for the message.
        work: takes a function that tells at which stage it is.

    Raises:
        Crashed: where the child ended without an answer; the reason names the stage.
    """
    ended = run_watched(what, work)
    if ended.error is not None:
        raise ended.error
    return cast("T", ended.result)


def run_watched(what: str, work: Callable[[Tell], T], limits: Limits = NO_LIMITS) -> Ended[T]:
    """Does `work` in a child process, which is ended where it goes over a limit."""
    sys.stdout.flush()
    sys.stderr.flush()
    answers, hers = Pipe(duplex=False)
    parent = os.getpid()
    start = time.monotonic()
    with ended_by_signals():
        child = os.fork()
        if child == 0:
            try:
                answers.close()
                _be_the_child(parent, hers, work)
            finally:
                os._exit(1)
        hers.close()
        watch = _Watch(what, child, limits, start)
        try:
            with answers:
                result, error = watch.answer(answers)
        finally:
            kill = watch.over is not None or sys.exc_info()[0] is not None
            status, usage = _wait(child, kill)
    if watch.over is not None:
        error = watch.over
    elif watch.silent:
        _clear_line()
        error = Crashed(f"{what}: {_how_it_ended(status, watch.stage)}")
    return Ended(
        result,
        error,
        time.monotonic() - start,
        max(watch.cpu_seconds, usage.ru_utime + usage.ru_stime),
        max(watch.memory, usage.ru_maxrss * 1024),
    )


class _Watch:
    """Waits for the answer of a child, and looks at what it uses meanwhile."""

    def __init__(self, what: str, child: int, limits: Limits, start: float) -> None:
        self.stage = "start"
        self.over: DevsegError | None = None
        self.silent = False  # it ended without an answer
        self.cpu_seconds = 0.0
        self.memory = 0
        self._what = what
        self._child = child
        self._limits = limits
        self._start = start

    def answer(self, pipe: Connection) -> tuple[Any, BaseException | None]:
        """What the work returned, or what it raised."""
        limited = self._limits != NO_LIMITS
        # A process that was ended may have sent half of a message.
        with contextlib.suppress(EOFError, OSError, pickle.UnpicklingError):
            while True:
                while limited and not pipe.poll(_LOOK_SECONDS):
                    self.over = self._look()
                    if self.over is not None:
                        return None, self.over
                kind, value = pipe.recv()
                if kind == "stage":
                    self.stage = value
                elif kind == "result":
                    return value, None
                else:
                    return None, value
        self.silent = True
        return None, None

    def _look(self) -> DevsegError | None:
        with contextlib.suppress(OSError):  # it has just ended
            self.cpu_seconds, memory = _used(self._child)
            self.memory = max(self.memory, memory)
        limits, waited = self._limits, time.monotonic() - self._start
        if limits.memory is not None and self.memory > limits.memory:
            return OverMemory(
                f"{self._what}: took more than {limits.memory / 2**30:g} GB in stage {self.stage}; "
                "simplify the mesh (--target-faces N), or allow more"
            )
        if limits.seconds is not None and (
            min(self.cpu_seconds, waited) > limits.seconds or waited > BUSY * limits.seconds
        ):
            return OverTime(
                f"{self._what}: took more than {limits.seconds:g} s, in stage {self.stage}; "
                "simplify the mesh (--target-faces N), or allow more"
            )
        return None


def _used(pid: int) -> tuple[float, int]:
    """Processor seconds of a process, and the most bytes of memory that it has had."""
    folder = Path(f"/proc/{pid}")
    fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
    peak = re.search(r"^VmHWM:\s*(\d+)", (folder / "status").read_text(), re.MULTILINE)
    seconds = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return seconds, 1024 * int(peak[1]) if peak else 0


@contextlib.contextmanager
def limited_reading(size: int) -> Iterator[None]:
    """Ends the child where the block takes much longer than a file of so many bytes can take.

    Other processes are left alone.
    """
    if not _is_child:
        yield
        return
    limit = READING_SECONDS + READING_SECONDS_PER_MB * size / 1e6
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


_is_child = False


def _be_the_child(parent: int, out: Connection, work: Callable[[Tell], Any]) -> None:
    """Works, sends the answer and ends without the clean-up of what the parent still uses."""
    global _is_child
    _is_child = True
    host.own_process()
    # The parent tells of Ctrl+C, and ends this process; it also ends with its parent.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    end_with_parent(parent)
    with out:
        try:
            result = work(lambda stage: out.send(("stage", stage)))
            out.send(("result", result))
        except BaseException as error:
            if os.environ.get("DEVSEG_DEBUG"):
                traceback.print_exc()
            out.send(("error", _portable(error)))
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(0)


def end_with_parent(parent: int) -> None:
    """From now on this process ends with the one that started it."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def _portable(error: BaseException) -> BaseException:
    """The error itself where it survives being sent, else one of the same words."""
    try:
        copy = pickle.loads(pickle.dumps(error))
    except Exception:
        copy = None
    if type(copy) is type(error) and str(copy) == str(error):
        return error
    return RuntimeError(f"{type(error).__name__}: {error}")


@contextlib.contextmanager
def ended_by_signals() -> Iterator[None]:
    """What ends a program is as Ctrl+C while the block runs: what was begun is cleared away."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with contextlib.ExitStack() as stack:
        # Signals are for the main thread alone.
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGTERM, signal.SIGHUP):
                stack.callback(signal.signal, number, signal.signal(number, interrupt))
        yield


def _wait(child: int, kill: bool) -> tuple[int, resource.struct_rusage]:
    """What a child ended with and what it used; ends it where its answer is not wanted any more."""
    if kill:
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        _clear_line()
    _, status, usage = os.wait4(child, 0)
    return os.waitstatus_to_exitcode(status), usage


def _clear_line() -> None:
    # It told the stage, and has no end.
    if sys.stderr.isatty():
        sys.stderr.write(CLEAR_LINE)


def _how_it_ended(status: int, stage: str) -> str:
    if status == -signal.SIGKILL:
        return (
            f"ended by the system in stage {stage}, most likely for lack of memory; close other "
            "programs, or simplify the mesh (--target-faces N)"
        )
    if status == -signal.SIGPROF:
        how = "did not come to an end"
    elif status >= 0:
        how = f"ended with status {status}"
    else:
        name = signal.Signals(-status).name
        how = f"crashed with {name} ({one_line(signal.strsignal(-status) or name).lower()})"
    if stage == READING:
        return (
            f"{how} in stage {stage}: the file is damaged in a way that the reader of its format "
            "does not notice; export it again, or as another format"
        )
    return f"{how} in stage {stage}; please report it with this file"
