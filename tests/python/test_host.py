"""What the host prints stays where it belongs."""

from __future__ import annotations

import subprocess
import sys

import pytest

CODE = """
import ctypes, os, sys
from devseg import host
libc = ctypes.CDLL(None)
print("before")
with host.captured() as chatter:
    libc.printf(b"buffered by C\\n")
    os.write(1, b"descriptor\\n")
    os.write(2, b"error\\n")
    print("python")
    print("python error", file=sys.stderr)
print("after")
parts = ("buffered by C", "descriptor", "error", "python", "python error")
sys.exit([part for part in parts if part not in chatter.text] or None)
"""


@pytest.mark.parametrize("debug", ["", "1"])
def test_chatter_is_captured(debug: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        env={"DEVSEG_DEBUG": debug},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "before\nafter\n"
    assert ("buffered by C" in done.stderr) == (debug == "1")


def test_descriptors_are_restored_after_an_error() -> None:
    code = """
from devseg import host
try:
    with host.captured():
        raise KeyError("inside")
except KeyError:
    print("out again")
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("out again\n", "")
