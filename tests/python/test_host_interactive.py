"""docs/interactive.md in MeshLab's window, step by step, with mouse and keyboard.

Slow: it runs where the other tests of the window do (test_host_window.py).
"""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import hosts
from meshlab_window import MeshLabWindow
from window_filters import (
    FLAVOURS,
    PICTURES,
    applied,
    find,
    needs_window,
    opened,
    save_pattern,
    tell,
)

pytestmark = needs_window

FACES = "Select Faces in a rect"  # "rectagular" in 2020.09
VERTICES = "Select Vertices"


@pytest.fixture(scope="module", params=FLAVOURS)
def flavour(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture(scope="module")
def window(
    flavour: str, pymeshlab: ModuleType, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[MeshLabWindow]:
    with opened(flavour, pymeshlab, tmp_path_factory.mktemp("window")) as running:
        yield running


def filter_named(name: str) -> dict[str, Any]:
    return next(f for f in hosts.declarations() if f["menu_name"] == name)


def results(lines: list[str]) -> dict[str, float]:
    """The numbers that a filter has logged."""
    found = (re.search(r"(\w+): (-?[\d.]+(?:e[+-]?\d+)?)$", line) for line in lines)
    return {match[1]: float(match[2]) for match in found if match}


def refusal(window: MeshLabWindow) -> str:
    """What the message says that a failing filter puts up; nothing where there is none."""
    said = (str(w.get("text") or "") for w in window.widgets())
    return next((text for text in said if "Failure of filter" in text), "")


def attempt(window: MeshLabWindow, name: str, **values: Any) -> dict[str, float] | str:
    """Finds the filter, fills in its dialog, applies it and closes the dialog.

    Its results, or what it says why it refuses.
    """
    before, lines = applied(window, name), len(window.log())
    find(window, name)
    window.wait_for(
        f"the dialog of {name}",
        lambda: window.widgets(dock=name, text="Apply") or applied(window, name) > before,
    )
    if window.widgets(dock=name, text="Apply"):
        tell(window, filter_named(name), values)
        window.click(window.widgets(dock=name, text="Apply")[0])
    window.wait_for(f"the end of {name}", lambda: applied(window, name) > before or refusal(window))
    reason = refusal(window)
    if reason:
        window.press("Return")
    if window.widgets(dock=name, text="Close"):
        window.click(window.widgets(dock=name, text="Close")[0])
    return reason or results(window.log()[lines:])


def apply(window: MeshLabWindow, name: str, **values: Any) -> dict[str, float]:
    """The same for what must not be refused."""
    found = attempt(window, name, **values)
    assert isinstance(found, dict), found
    return found


def scene(window: MeshLabWindow) -> tuple[int, int, int, int]:
    """Left, top, width and height of what shows the mesh."""
    areas = window.widgets(**{"class": "GLArea"})
    assert areas
    left, top, width, height = areas[0]["box"]
    return left, top, width, height


def select(
    window: MeshLabWindow, tool: str, start: tuple[float, float], end: tuple[float, float]
) -> None:
    """Takes a tool, draws a rectangle (shares of the scene), and puts the tool away again."""
    left, top, width, height = scene(window)
    buttons = [b for b in window.widgets() if "Button" in b["class"] and b["tip"].startswith(tool)]
    button = min(buttons, key=lambda b: len(b["tip"]))
    window.click(button)
    places = [(round(left + x * width), round(top + y * height)) for x, y in (start, end)]
    window.drag(*places)
    time.sleep(0.5)
    window.click(button)
    time.sleep(0.3)


def picture(window: MeshLabWindow, file: str) -> None:
    """What the scene shows."""
    left, top, width, height = scene(window)
    time.sleep(1.0)
    window.screenshot().crop((left, top, left + width, top + height)).save(PICTURES / file)


def dart_somewhere(window: MeshLabWindow) -> dict[str, float]:
    """A dart to a vertex inside of a chart: small rectangles may hold none, or one on a seam."""
    said: list[str] = []
    for k in range(12):
        x, y = 0.3 + 0.03 * k, 0.5 + 0.02 * (k % 3)
        select(window, VERTICES, (x, y), (x + 0.012, y + 0.012))
        found = attempt(window, "Charts: Add Dart", force=True)
        if isinstance(found, dict):
            return found
        said.append(found)
    raise AssertionError(said)


def test_a_seam_is_added_where_the_user_selects(
    window: MeshLabWindow, flavour: str, tmp_path: Path
) -> None:
    charts = apply(window, "Segmentation: D-Charts")["charts_number"]
    picture(window, f"{flavour}-interactive-charts.png")
    apply(window, "Charts: Flatten")
    assert apply(window, "Charts: Measure Flattening")["l2_stretch"] >= 1
    select(window, FACES, (0.05, 0.05), (0.5, 0.95))
    picture(window, f"{flavour}-interactive-selected.png")
    added = apply(window, "Charts: From Selected Edges")
    assert added["charts_number"] > charts
    select(window, FACES, (0.001, 0.001), (0.002, 0.002))  # nothing: the red goes
    picture(window, f"{flavour}-interactive-added.png")
    assert apply(window, "Charts: Flatten")["charts_number"] >= added["charts_number"]
    text = save_pattern(window, tmp_path / "bunny.svg")
    assert text.count("<path") > 3 and text.rstrip().endswith("</svg>")


def test_charts_are_changed_as_the_table_says(window: MeshLabWindow) -> None:
    charts = apply(window, "Segmentation: D-Charts")["charts_number"]
    select(window, FACES, (0.05, 0.05), (0.5, 0.95))
    joined = apply(window, "Charts: Join Selected", force=True)
    assert joined["charts_number"] < charts
    assert joined["l2_stretch"] >= 1
    split = apply(window, "Charts: Split Selected", along_selection=False, force=True)
    assert split["charts_number"] > joined["charts_number"]
    removed = apply(window, "Charts: Remove Selected Seams", force=True)
    assert removed["charts_number"] < split["charts_number"]
    assert dart_somewhere(window)["cut_length"] > 0
    assert apply(window, "Charts: Refine")["charts_number"] >= removed["charts_number"]
    assert "seam_length" in apply(window, "Charts: Smooth Seams")


def test_a_refusal_says_what_it_would_cost_and_changes_nothing(window: MeshLabWindow) -> None:
    charts = apply(window, "Segmentation: D-Charts")["charts_number"]
    select(window, FACES, (0.02, 0.02), (0.98, 0.98))
    reason = attempt(window, "Charts: Join Selected")
    assert isinstance(reason, str) and "L2 stretch of" in reason
    assert apply(window, "Charts: Colorize")["charts_number"] == charts


def test_only_the_selection_and_seams_that_stay(window: MeshLabWindow) -> None:
    name = "Segmentation: Variational Shape Approximation"
    charts = apply(window, name)["charts_number"]
    more = apply(window, name, keep=1)
    assert more["charts_number"] >= charts
    apply(window, "Charts: Flatten")
    select(window, FACES, (0.05, 0.05), (0.5, 0.95))
    apply(window, name, selected_only=True)
    apply(window, "Charts: Flatten", selected_only=True)
    assert apply(window, "Charts: Measure Flattening")["flipped_faces_number"] == 0
