"""Work in a child process: its answer, its errors, and its end by a signal."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import meshes
from devseg import apart
from devseg.apart import Tell, run_apart
from devseg.cli import main
from devseg.errors import DevsegError


def test_the_answer_comes_back() -> None:
    assert run_apart("a.obj", lambda tell: {"child": os.getpid()})["child"] != os.getpid()


@pytest.mark.parametrize("error", [DevsegError("no faces"), OSError(28, "No space", "a.ply")])
def test_an_error_comes_back(error: Exception) -> None:
    def fail(_: Tell) -> None:
        raise error

    with pytest.raises(type(error)) as caught:
        run_apart("a.obj", fail)
    assert str(caught.value) == str(error)


@pytest.mark.parametrize(
    ("number", "stage", "words"),
    [
        (signal.SIGSEGV, "load", "a.obj: crashed with SIGSEGV .* in stage load: the file is damag"),
        (signal.SIGABRT, "svg", "a.obj: crashed with SIGABRT .* in stage svg; please report it"),
        (signal.SIGKILL, "flatten", "a.obj: ended by the system in stage flatten, .* memory"),
    ],
)
def test_a_signal_is_told(number: int, stage: str, words: str) -> None:
    def end(tell: Tell) -> None:
        tell(stage)
        os.kill(os.getpid(), number)

    with pytest.raises(DevsegError, match=words):
        run_apart("a.obj", end)


def test_a_wrong_address_is_told() -> None:
    import ctypes

    def jump(_: Tell) -> None:
        ctypes.string_at(8)

    with pytest.raises(DevsegError, match="SIGSEGV"):
        run_apart("a.obj", jump)


@pytest.mark.parametrize("stage", ["load", "svg"])
def test_a_crash_leaves_nothing(
    stage: str, obj: Callable, tmp_path: Path, fails: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crash(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGSEGV)

    target = "load_mesh" if stage == "load" else "Session.export"
    monkeypatch.setattr(f"devseg.pipeline.{target}", crash)
    error = fails("run", obj(meshes.cube()), "-o", tmp_path / "out", "--charts", 3)
    assert "mesh.obj: crashed with SIGSEGV" in error and f"stage {stage}" in error
    assert not (tmp_path / "out").exists()


def test_reading_without_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "READING_SECONDS", 0.2)

    def read(tell: Tell) -> None:
        tell(apart.READING)
        with apart.limited_reading(1000):
            while True:
                pass

    with pytest.raises(DevsegError, match="did not come to an end in stage load"):
        run_apart("a.obj", read)
    # What comes after reading may take its time, and so may readers in other processes.
    with apart.limited_reading(1000):
        spend(0.4)

    def work(_: Tell) -> str:
        with apart.limited_reading(1000):
            pass
        spend(0.4)
        return "done"

    assert run_apart("a.obj", work) == "done"


def spend(seconds: float) -> None:
    start = time.process_time()
    while time.process_time() - start < seconds:
        pass


SLEEPER = """
import os, sys, time
from devseg.apart import run_apart
def work(tell):
    print(os.getpid(), flush=True)
    time.sleep(60)
try:
    run_apart("a.obj", work)
finally:
    print("cleared", flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_the_child_ends_with_its_parent(number: int) -> None:
    parent = subprocess.Popen(
        [sys.executable, "-c", SLEEPER], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    child = int(parent.stdout.readline())
    parent.send_signal(number)
    parent.wait(timeout=10)
    assert parent.stdout.read() == (b"" if number == signal.SIGKILL else b"cleared\n")
    for _ in range(100):
        if not _runs(child):
            return
        time.sleep(0.05)
    pytest.fail("the child goes on")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_leaves_nothing(number: int, obj: Callable, tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-m", "devseg", "run", obj(meshes.sphere(300, 200)), "-o", out]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    for _ in range(200):
        if out.is_dir() and any(out.iterdir()):
            break
        time.sleep(0.02)
    time.sleep(0.5)  # by now it works
    process.send_signal(number)
    printed, error = process.communicate(timeout=10)
    assert (process.returncode, printed) == (1, "")
    assert error.startswith("devseg: error: interrupted") and error.count("\n") == 1
    assert not out.exists()


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("command", ["run", "measure", "compare"])
def test_the_parent_imports_neither_the_host_nor_numpy(
    command: str, obj: Callable, tmp_path: Path
) -> None:
    """Either would take as long as everything else that it does."""
    mesh = obj(meshes.cube())
    words = {
        "run": [mesh, "-o", tmp_path],
        "measure": [tmp_path / "mesh.ply"],
        "compare": [mesh, "-o", tmp_path, "--methods", "vsa", "--charts", "6"],
    }
    assert main(["run", str(mesh), "-o", str(tmp_path)]) == 0
    code = (
        "import sys, devseg.cli\n"
        "assert devseg.cli.main(sys.argv[1:]) == 0\n"
        "assert not {'numpy', 'pymeshlab'} & set(sys.modules)\n"
    )
    subprocess.run(
        [sys.executable, "-c", code, command, *map(str, words[command])],
        check=True,
        stdout=subprocess.DEVNULL,
    )
