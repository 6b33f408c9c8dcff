"""MeshLab's window with our plugins: opening it, and finding, filling in and applying filters."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import hosts
from conftest import ROOT
from meshlab_window import INSPECTOR, MeshLabWindow, Widget

PICTURES = ROOT / "build" / "screenshots"


FLAVOURS = ("meshlab-2020.09", "meshlab-2025.07")
ASKED = os.environ.get("DEVSEG_GUI_TESTS") == "1"
BUILT = (hosts.CACHE / "meshlab-2025.07-window" / "meshlab").is_file()
needs_window = pytest.mark.skipif(
    not (ASKED or BUILT), reason="no MeshLab 2025.07 in the cache, and no DEVSEG_GUI_TESTS=1"
)


@contextlib.contextmanager
def opened(flavour: str, pymeshlab: ModuleType, folder: Path) -> Iterator[MeshLabWindow]:
    """A MeshLab with a bunny, as PLY: MeshLab 2020.09 stops at some OBJ files."""
    for program in ("Xvfb", "xdotool"):
        if shutil.which(program) is None:
            hosts.missing(f"no {program} on this machine")
    if not INSPECTOR.is_file():
        hosts.missing("the window inspector is not built; run scripts/setup.sh")
    samples = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
    meshset = pymeshlab.MeshSet()
    meshset.load_new_mesh(str(samples / "bunny10k_textured.obj"))
    file = folder / "bunny.ply"
    meshset.save_current_mesh(
        str(file), save_vertex_color=False, save_face_color=False, save_wedge_texcoord=False
    )
    meshlab = hosts.PrivateMeshLab.make(folder / "meshlab", flavour)
    PICTURES.mkdir(parents=True, exist_ok=True)
    with MeshLabWindow(meshlab, file) as running:
        yield running


def find(window: MeshLabWindow, name: str) -> None:
    """Starts a filter as MeshLab's help tells: Ctrl+F, its name, and its line in the list."""
    window.focus("MeshLab")
    window.press("ctrl+f", "ctrl+a")  # the last name may stand there still
    window.type(name)

    def listed() -> int:
        typed = [w for w in window.widgets(text=name) if "LineEdit" in w["class"]]
        if not typed:  # the list will change
            return 0
        for menu in window.menus():
            entries = [e["text"] for e in menu["entries"] if e["text"]]
            if menu["visible"] and name in entries:
                return entries.index(name) + 1
        return 0

    line = window.wait_for(f"{name} in the search", listed)
    window.press(*["Down"] * line, "Return")


def applied(window: MeshLabWindow, name: str) -> int:
    """How often the log tells that the filter was applied."""
    line = re.compile(rf"Applied filter:? {re.escape(name)} in \d+ msec")
    return sum(1 for text in window.log() if line.search(text))


def save_pattern(window: MeshLabWindow, file: Path) -> str:
    """Saves the mesh as SVG by the menu of files; what was written."""
    window.focus("MeshLab")
    window.press("ctrl+shift+e")
    window.wait_for("the file dialog", lambda: window.widgets(**{"class": "QFileDialog"}))
    window.focus("Save ")
    window.press("ctrl+a")
    window.type(str(file))
    window.press("Return")
    okay = window.wait_for(
        "the saving options", lambda: window.widgets(text="OK") + window.widgets(text="&OK")
    )
    window.screenshot().save(PICTURES / f"{window.meshlab.installation.flavour}-export.png")
    window.click(okay[0])
    window.wait_for("the pattern", file.is_file)
    return file.read_text()


def row_of(window: MeshLabWindow, dock: str, label: str) -> list[Widget]:
    """The widgets of a dialog beside a label, and the label."""
    shown = window.widgets(dock=dock)
    named = [w for w in shown if w.get("text") == label]
    assert named, f"{label} in the dialog of {dock}"
    return [w for w in shown if abs(middle(w) - middle(named[0])) < 8]


def middle(widget: Widget) -> float:
    return widget["box"][1] + widget["box"][3] / 2


def tell(window: MeshLabWindow, filter_: dict[str, Any], values: dict[str, Any]) -> None:
    """Writes values into the dialog of a filter; of a choice, its position."""
    name = filter_["menu_name"]
    for parameter in filter_["parameters"]:
        value = values.get(parameter["name"])
        if value is None:
            continue
        row = row_of(window, name, parameter["label"])
        window.focus(name)
        if parameter["kind"] == "boolean":
            box = next(w for w in row if w["class"] == "QCheckBox")
            if box["checked"] != value:
                left, top, _, height = box["box"]
                window.click({"box": (left, top, height, height)})  # the rest of it is no button
            continue
        if parameter["kind"] == "choice":
            window.click(next(w for w in row if w["class"] == "QComboBox"))
            window.press("Home", *["Down"] * value, "Return")
            continue
        window.click(next(w for w in row if w["class"] == "QLineEdit"))
        window.press("ctrl+a")
        window.type(value)
