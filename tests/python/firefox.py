"""Firefox on an X server without a screen, driven by WebDriver BiDi.

Debian has no geckodriver, which Selenium needs for Firefox; BiDi is spoken by Firefox itself.
Without a display, Firefox has no WebGL: it gets a display that nobody sees.
"""

from __future__ import annotations

import base64
import json
import os
import re
import subprocess
import time
from io import BytesIO
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from PIL import Image

SIZE = (1280, 1000)
PATIENCE = 120.0  # seconds; software rendering on a busy machine is slow
# WebGL although no graphics card is known.
PREFERENCES = """
user_pref("webgl.force-enabled", true);
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
"""


class Firefox:
    """A running Firefox with one page; a context."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._processes: list[subprocess.Popen[bytes]] = []
        self._socket: Any = None
        self._sent = 0
        self.errors: list[str] = []  # that the console shows

    def __enter__(self) -> Firefox:
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
        import websocket

        profile = self._folder / "profile"
        profile.mkdir()
        (profile / "user.js").write_text(PREFERENCES, encoding="utf-8")
        log = self._folder / "firefox.log"
        read, write = os.pipe()
        screen = f"{SIZE[0] + 100}x{SIZE[1] + 200}x24"
        with log.open("wb") as out:
            self._processes.append(
                subprocess.Popen(
                    ["Xvfb", "-displayfd", str(write), "-screen", "0", screen],
                    pass_fds=[write],
                    stdout=out,
                    stderr=out,
                )
            )
            os.close(write)
            with os.fdopen(read) as answer:
                display = f":{int(answer.readline())}"
            self._processes.append(
                subprocess.Popen(
                    [
                        "firefox-esr",
                        "--no-remote",
                        "--profile",
                        profile,
                        "--remote-debugging-port=0",
                    ],
                    env={
                        **os.environ,
                        "HOME": str(self._folder),
                        "DISPLAY": display,
                        "LIBGL_ALWAYS_SOFTWARE": "1",
                        "MOZ_DISABLE_CONTENT_SANDBOX": "1",  # it stops root in a container
                    },
                    stdout=out,
                    stderr=out,
                )
            )
        end = time.monotonic() + PATIENCE
        while not (found := re.search(r"BiDi listening on (ws://\S+)", log.read_text("utf-8"))):
            assert time.monotonic() < end, "Firefox does not start: " + log.read_text("utf-8")
            time.sleep(0.05)
        self._socket = websocket.create_connection(
            found[1] + "/session", suppress_origin=True, timeout=PATIENCE
        )
        self._send("session.new", capabilities={})
        self._send("session.subscribe", events=["log.entryAdded"])
        self._page = self._send("browsingContext.getTree")["contexts"][0]["context"]
        viewport = {"width": SIZE[0], "height": SIZE[1]}
        self._send("browsingContext.setViewport", context=self._page, viewport=viewport)

    def _stop(self) -> None:
        if self._socket is not None:
            self._send("browser.close")
            self._socket.close()
        for process in reversed(self._processes):
            process.terminate()
            process.wait(timeout=PATIENCE)

    def _send(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._sent += 1
        self._socket.send(json.dumps({"id": self._sent, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv())
            if message.get("id") == self._sent:
                assert message["type"] == "success", message
                result: dict[str, Any] = message["result"]
                return result
            if message.get("params", {}).get("level") == "error":
                self.errors.append(message["params"]["text"])

    def open(self, url: str) -> None:
        self._send("browsingContext.navigate", context=self._page, url=url, wait="complete")

    def run(self, script: str) -> Any:
        """What a script returns."""
        result = self._send(
            "script.evaluate",
            expression=f"JSON.stringify((() => {{ {script} }})() ?? null)",
            target={"context": self._page},
            awaitPromise=True,
        )
        assert result["type"] == "success", result["exceptionDetails"]["text"]
        return json.loads(result["result"]["value"])

    def point(self, x: float, y: float, press: bool = False) -> None:
        """Moves the mouse, and presses its button."""
        actions: list[dict[str, Any]] = [{"type": "pointerMove", "x": round(x), "y": round(y)}]
        if press:
            actions += [{"type": f"pointer{way}", "button": 0} for way in ("Down", "Up")]
        source = {"type": "pointer", "id": "mouse", "actions": actions}
        self._send("input.performActions", context=self._page, actions=[source])

    def picture(self) -> np.ndarray:
        """Of the page, #rows by #columns by 3."""
        data = self._send("browsingContext.captureScreenshot", context=self._page)["data"]
        image = Image.open(BytesIO(base64.b64decode(data)))
        return np.asarray(image.convert("RGB")).astype(int)
