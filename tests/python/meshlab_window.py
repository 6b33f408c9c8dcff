"""MeshLab's window on an X server without a screen, used as a user does.

Mouse and keyboard are the X server's (xdotool); a library preloaded into MeshLab tells what its
widgets show (tests/host/window_inspector.cpp).
"""

from __future__ import annotations

import datetime
import json
import os
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any, TypeVar

from PIL import Image, ImageGrab

import hosts
from conftest import ROOT

INSPECTOR = ROOT / "build" / "release" / "tests" / "libdevseg_window_inspector.so"
SIZE = (1280, 1600)  # the dialog of "Pattern: Export" is higher than usual screens
PATIENCE = 120.0  # seconds; software rendering on a busy machine is slow

Widget = dict[str, Any]
T = TypeVar("T")


class MeshLabWindow:
    """A running MeshLab; a context."""

    def __init__(self, meshlab: hosts.PrivateMeshLab, mesh: Path) -> None:
        self.meshlab = meshlab
        self.mesh = mesh
        self._processes: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> MeshLabWindow:
        try:
            self._start()
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._stop()

    def _start(self) -> None:
        self._log = (self.meshlab.folder / "window.log").open("wb")
        read, write = os.pipe()
        self._processes.append(
            subprocess.Popen(
                ["Xvfb", "-displayfd", str(write), "-screen", "0", "{}x{}x24".format(*SIZE)],
                pass_fds=[write],
                stdout=self._log,
                stderr=self._log,
            )
        )
        os.close(write)
        with os.fdopen(read) as answer:
            self.display = f":{int(answer.readline())}"
        environment = self.meshlab.environment()
        _settle_first_questions(Path(environment["XDG_CONFIG_HOME"]))
        self._socket_path = self.meshlab.folder / "inspector"
        self._socket_path.unlink(missing_ok=True)
        environment |= {
            "DISPLAY": self.display,
            "LD_PRELOAD": str(INSPECTOR),
            "DEVSEG_INSPECTOR": str(self._socket_path),
        }
        self._processes.append(
            subprocess.Popen(
                [self.meshlab.folder / "meshlab", self.mesh],
                env=environment,
                stdout=self._log,
                stderr=self._log,
            )
        )
        self.wait_for("the inspector", self._socket_path.exists)
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(str(self._socket_path))
        self._answers = self._socket.makefile("rwb")
        self.wait_for("the mesh", lambda: any("All files opened" in line for line in self.log()))
        self._xdotool("search", "--onlyvisible", "--name", "MeshLab", "windowsize", "100%", "100%")
        time.sleep(1.0)

    def _stop(self) -> None:
        for process in reversed(self._processes):
            process.kill()
            process.wait()
        self._log.close()

    def _ask(self, question: str) -> list[dict[str, Any]]:
        self._answers.write(question.encode() + b"\n")
        self._answers.flush()
        return json.loads(self._answers.readline())

    def _xdotool(self, *arguments: str) -> None:
        subprocess.run(
            ["xdotool", *arguments],
            env={**os.environ, "DISPLAY": self.display},
            check=True,
            stdout=subprocess.DEVNULL,
        )

    def wait_for(self, what: str, found: Callable[[], T]) -> T:
        """Asks until the answer is true; fails with a screenshot when that takes too long."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            answer = found()
            if answer:
                return answer
            time.sleep(0.1)
        picture = self.meshlab.folder / "failed.png"
        self.screenshot().save(picture)
        raise AssertionError(f"{what} did not appear within {PATIENCE:.0f} s; see {picture}")

    def widgets(self, **properties: Any) -> list[Widget]:
        """The visible widgets with these properties."""
        return [
            widget
            for widget in self._ask("widgets")
            if widget["visible"] and all(widget.get(k) == v for k, v in properties.items())
        ]

    def menus(self) -> list[dict[str, Any]]:
        return self._ask("menus")

    def log(self) -> list[str]:
        """The lines of MeshLab's log, in its layer dialog."""
        texts = [w["plainText"] for w in self._ask("widgets") if w["class"] == "QPlainTextEdit"]
        return "\n".join(texts).splitlines()

    def click(self, widget: Widget) -> None:
        x, y, width, height = widget["box"]
        self._xdotool("mousemove", str(x + width // 2), str(y + height // 2))
        self._xdotool("click", "1")

    def drag(self, start: tuple[int, int], end: tuple[int, int]) -> None:
        self._xdotool("mousemove", *map(str, start), "mousedown", "1")
        for step in (0.1, 0.5, 1.0):
            time.sleep(0.1)
            at = (round(a + step * (b - a)) for a, b in zip(start, end, strict=True))
            self._xdotool("mousemove", *map(str, at))
        self._xdotool("mouseup", "1")

    def focus(self, title: str) -> None:
        """Gives the keyboard to the window whose title has this in it: no window manager does."""
        self._xdotool("search", "--onlyvisible", "--name", title, "windowfocus", "--sync", "%1")

    def press(self, *keys: str) -> None:
        self._xdotool("key", "--delay", "60", *keys)

    def type(self, text: str) -> None:
        self._xdotool("type", "--delay", "15", text)

    def screenshot(self) -> Image.Image:
        return ImageGrab.grab(xdisplay=self.display)


def _settle_first_questions(config: Path) -> None:
    """MeshLab asks once about statistics and looks for a newer version once a day: not here."""
    today = datetime.date.today()
    date = f"{today:%a %b} {today.day} {today.year}"
    for name in ("MeshLab_64bit_fp", "MeshLab"):
        file = config / "VCG" / f"{name}.conf"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(
            f"[General]\ninformativeShown=true\nlastTimeMeshLabVersionCheckedOnStart={date}\n"
        )
