"""Workers of a batch: processes that have imported the host already, and fork for each mesh.

    python -m devseg.batch_worker FD PARENT

reads tasks from the connection FD and answers each with its record. Importing the host takes longer
than most meshes do. A fork costs milliseconds, and every mesh still has a process of its own.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
from multiprocessing import Pipe
from multiprocessing.connection import Connection

from devseg import host
from devseg.apart import end_with_parent
from devseg.batch_store import Record
from devseg.batch_task import Task, lost, run_task

# A worker that ends with a mesh is replaced, and the mesh is tried so many times. Workers end where
# the system is short of memory, or somebody ends them.
_TRIES = 3


class Worker:
    """A worker process, started when there is something to do."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: Connection | None = None
        self._closed = False
        self._lock = threading.Lock()  # around starting and closing

    def run(self, task: Task) -> Record:
        """Does a task; raises what run_task raises."""
        for _ in range(_TRIES):
            try:
                pipe = self._start()
                pipe.send(task)
                answer: Record | BaseException = pipe.recv()
            except (EOFError, OSError):
                with self._lock:
                    self._end()
                    if self._closed:
                        raise KeyboardInterrupt from None
                continue
            if isinstance(answer, BaseException):
                raise answer
            return answer
        return lost(task)

    def close(self) -> None:
        """Ends the process, with what it is doing."""
        with self._lock:
            self._closed = True
            self._end()

    def _start(self) -> Connection:
        with self._lock:
            if self._closed:
                raise EOFError
            if self._pipe is None:
                ours, theirs = Pipe()
                with theirs:
                    self._process = subprocess.Popen(
                        [
                            sys.executable,
                            "-m",
                            "devseg.batch_worker",
                            str(theirs.fileno()),
                            str(os.getpid()),
                        ],
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.DEVNULL,
                        # Stages are for people who wait for a single mesh.
                        stderr=None if os.environ.get("DEVSEG_DEBUG") else subprocess.DEVNULL,
                        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
                        pass_fds=[theirs.fileno()],
                    )
                self._pipe = ours
            return self._pipe

    def _end(self) -> None:
        if self._process is not None:
            self._process.terminate()  # it clears away what it has begun
            self._process.wait()
        if self._pipe is not None:
            self._pipe.close()
        self._process = self._pipe = None


def serve(pipe: Connection) -> None:
    """Does tasks until there are no more."""
    failed: BaseException | None = None
    try:
        _warm_up()
    except Exception as error:
        failed = error
    with contextlib.suppress(EOFError, KeyboardInterrupt):
        while True:
            task: Task = pipe.recv()
            try:
                pipe.send(failed or run_task(task))
            except Exception as error:
                pipe.send(error)


def _warm_up() -> None:
    """Imports all that a mesh needs."""
    import numpy  # noqa: F401
    from PIL import Image

    from devseg import render  # noqa: F401
    from devseg.plugins import load_plugins

    Image.init()
    load_plugins()


def main() -> None:
    """Serves the connection that the arguments name."""
    end_with_parent(int(sys.argv[2]))
    host.own_process()
    # Ctrl+C is for the one who asked.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    serve(Connection(int(sys.argv[1])))


if __name__ == "__main__":
    main()
