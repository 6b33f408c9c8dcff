"""MeshLab's window: every filter is found by search, explains itself and runs; colours; export.

Slow, and MeshLab 2025.07 has to be built for it once (scripts/build_meshlab.sh): it runs where that
has been done, or where DEVSEG_GUI_TESTS=1 asks for it.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from PIL import Image

import hosts
import reference
from meshlab_window import MeshLabWindow, Widget
from window_filters import (
    FLAVOURS,
    PICTURES,
    applied,
    find,
    needs_window,
    opened,
    row_of,
    save_pattern,
    tell,
)

pytestmark = needs_window


@pytest.fixture(scope="module", params=FLAVOURS)
def flavour(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def window(
    flavour: str, pymeshlab: ModuleType, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[MeshLabWindow]:
    with opened(flavour, pymeshlab, tmp_path_factory.mktemp("window")) as running:
        yield running


def check_dialog(window: MeshLabWindow, filter_: dict[str, Any]) -> None:
    """The filter's help, and each parameter with its label, its default and its help."""
    dock = filter_["menu_name"]
    assert any(filter_["help"] in (w.get("text") or "") for w in window.widgets(dock=dock))
    for parameter in filter_["parameters"]:
        row = row_of(window, dock, parameter["label"])
        if parameter["kind"] == "boolean":
            values = [w["checked"] for w in row if w["class"] == "QCheckBox"]
            expected = parameter["default"]
        elif parameter["kind"] == "choice":
            values = [w["currentText"] for w in row if w["class"] == "QComboBox"]
            expected = parameter["choices"][parameter["default"]]
        else:
            values = [w["text"] for w in row if w["class"] == "QLineEdit"]
            expected = reference.written_default(parameter)
        assert values == [expected], parameter["name"]
    if filter_["parameters"]:
        explained = {f"<small>{p['help']}</small>" for p in filter_["parameters"]}
        window.click(window.widgets(dock=dock, text="Help")[0])
        window.wait_for(
            f"the help of {dock}",
            lambda: explained <= {w.get("text") for w in window.widgets(dock=dock)},
        )
        window.click(window.widgets(dock=dock, text="Help")[0])


def run_filter(
    window: MeshLabWindow, filter_: dict[str, Any], folder: Path, picture: Path | None = None
) -> None:
    """Finds a filter, checks its dialog, applies it, takes a picture and closes the dialog."""
    name = filter_["menu_name"]
    before = applied(window, name)

    def dialog() -> list[Widget]:
        return window.widgets(dock=name, text="Apply")

    def ended() -> bool:
        return applied(window, name) > before

    find(window, name)
    # Filters without parameters have a dialog in some versions only.
    window.wait_for(f"the dialog of {name}", lambda: dialog() or ended())
    if dialog():
        check_dialog(window, filter_)
        tell(window, filter_, hosts.told(filter_, folder / "from_filter.svg", window.mesh))
        window.click(dialog()[0])
    else:
        assert not filter_["parameters"]
    window.wait_for(f"the end of {name}", ended)
    if picture is not None:
        show_beside(window, name, picture)
    if dialog():
        window.click(window.widgets(dock=name, text="Close")[0])


def show_beside(window: MeshLabWindow, dock: str, picture: Path) -> None:
    """A picture with the dialog at the right, where it hides the log and its file names."""
    docks = [w for w in window.widgets(dock=dock) if "Dialog" in w["class"]]
    x, y, width, height = docks[0]["box"]
    log = next(w["box"] for w in window.widgets(**{"class": "QPlainTextEdit"}))
    right = window.screenshot().width - x - width
    down = max(log[1] + log[3] - y - height, 0)
    window.drag((x + width // 3, y + 10), (x + width // 3 + right, y + 10 + down))
    time.sleep(1.0)
    window.screenshot().save(picture)


def surface(picture: Image.Image) -> np.ndarray:
    """Pixels of the mesh without colours: bright and grey, in the left half of the window."""
    rgb = np.asarray(picture.convert("RGB")).astype(int)[100:800, :700]
    return (np.ptp(rgb, axis=2) < 12) & (rgb.min(axis=2) > 60)


def hues(picture: Image.Image, where: np.ndarray) -> tuple[float, int]:
    """Share of coloured pixels, and number of hues that cover at least a hundredth each."""
    hsv = np.asarray(picture.convert("HSV")).astype(int)[100:800, :700][where]
    colored = hsv[hsv[:, 1] > 40]
    share = np.bincount(colored[:, 0] // 22, minlength=12) / len(hsv)
    return len(colored) / len(hsv), int((share >= 0.01).sum())


def colored(picture: Image.Image, mesh: np.ndarray) -> Image.Image | None:
    share, number = hues(picture, mesh)
    return picture if share > 0.6 and number >= 3 else None  # as many charts are seen


def test_charts_get_colors_and_their_pattern_is_exported(
    window: MeshLabWindow, flavour: str, tmp_path: Path
) -> None:
    plain = window.screenshot()
    mesh = surface(plain)
    assert mesh.sum() > 20000
    assert hues(plain, mesh)[0] < 0.01
    segment, flatten = hosts.prepared(hosts.declarations()[0])[:2]
    run_filter(window, segment, tmp_path, PICTURES / f"{flavour}-dialog.png")
    picture = window.wait_for(
        "the colours of the charts", lambda: colored(window.screenshot(), mesh)
    )
    picture.save(PICTURES / f"{flavour}-charts.png")
    run_filter(window, flatten, tmp_path)

    text = save_pattern(window, tmp_path / "bunny.svg")
    assert text.count("<path") > 3 and text.rstrip().endswith("</svg>")
    hosts.record(f"window-{flavour}", "Saving as SVG", "runs")


def test_every_filter_is_found_explains_itself_and_runs(
    window: MeshLabWindow, flavour: str, tmp_path: Path
) -> None:
    steps = hosts.prepared(hosts.declarations()[0])[:2]
    for step in steps:
        run_filter(window, step, tmp_path)
    # Those that make a layer come last: they make it the one that filters work on, and the next one
    # needs charts there.
    table = hosts.declarations()
    on_new_layer = False
    for filter_ in sorted(table, key=reference.makes_layer):
        if filter_["needs_texture"]:
            continue  # the mesh has none
        for step in steps if on_new_layer or filter_["needs_selection"] else ():
            run_filter(window, step, tmp_path)
        run_filter(window, filter_, tmp_path)
        on_new_layer = reference.makes_layer(filter_)
        hosts.record(f"window-{flavour}", filter_["menu_name"], "found, as declared, runs")
