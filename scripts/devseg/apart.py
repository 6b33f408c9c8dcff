"""Work in a child process, whose end is told, whatever ends it.

Readers of the host trust the files that they read, and a file that lies takes the process with it.
docs/decisions/0038 says why the whole work on a mesh happens here, and why the child is forked.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import pickle
import resource
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from typing import IO, Any, TypeVar

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

_PR_SET_PDEATHSIG = 1


def run_apart(what: str, work: Callable[[Tell], T]) -> T:
    """Does `work` in a child process and returns what it returned, or raises what it raised.

    Args:
        what: the work's input, for the message.
        work: takes a function that tells at which stage it is.

    Raises:
        DevsegError: where the child ended without an answer; the reason names the stage.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    answers, hers = os.pipe()
    parent = os.getpid()
    child = os.fork()
    if child == 0:
        os.close(answers)
        _be_the_child(parent, hers, work)
    os.close(hers)
    stage = "start"
    try:
        with _ended_by_signals(), os.fdopen(answers, "rb") as pipe:
            for kind, value in _messages(pipe):
                if kind == "stage":
                    stage = value
                elif kind == "result":
                    return value
                else:
                    raise value
    finally:
        status = _wait(child)
    _clear_line()
    raise DevsegError(f"{what}: {_how_it_ended(status, stage)}")


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


def _be_the_child(parent: int, out: int, work: Callable[[Tell], Any]) -> None:
    """Works, sends the answer and ends without the clean-up of what the parent still uses."""
    global _is_child
    _is_child = True
    # The parent tells of Ctrl+C, and ends this process; it also ends with its parent.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)
    with os.fdopen(out, "wb") as pipe:

        def send(kind: str, value: Any) -> None:
            pickle.dump((kind, value), pipe)
            pipe.flush()

        try:
            send("result", work(lambda stage: send("stage", stage)))
        except BaseException as error:
            if os.environ.get("DEVSEG_DEBUG"):
                traceback.print_exc()
            send("error", _portable(error))
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(0)


def _portable(error: BaseException) -> BaseException:
    """The error itself where it survives being sent, else one of the same words."""
    try:
        copy = pickle.loads(pickle.dumps(error))
    except Exception:
        copy = None
    if type(copy) is type(error) and str(copy) == str(error):
        return error
    return RuntimeError(f"{type(error).__name__}: {error}")


def _messages(pipe: IO[bytes]) -> Iterator[tuple[str, Any]]:
    # A process that was ended may have sent half of a message.
    with contextlib.suppress(EOFError, pickle.UnpicklingError):
        while True:
            yield pickle.load(pipe)


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[None]:
    """What ends a program is as Ctrl+C while the block runs: what was begun is cleared away."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with contextlib.ExitStack() as stack:
        # Signals are for the main thread alone.
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGTERM, signal.SIGHUP):
                stack.callback(signal.signal, number, signal.signal(number, interrupt))
        yield


def _wait(child: int) -> int:
    """Ends a child whose answer is complete or not wanted any more; what it ended with."""
    if sys.exc_info()[0] is not None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        _clear_line()
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


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
