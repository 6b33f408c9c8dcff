"""The HTML page of a pattern in a real browser."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import chromium
import firefox

PAGE_LIMIT = 5_000_000  # bytes
SCALE = 60.0  # mm for a unit


@pytest.fixture(scope="module")
def page(flattened: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "b\u00e4r <&>.html"
    flattened.apply_filter(
        "export_pattern", output_file=str(path), preset="Sewing", page="a4", mm_per_unit=SCALE
    )
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    if not chromium.is_there():
        if os.environ.get("DEVSEG_HOST_TESTS") == "required":
            pytest.fail("chromium and chromium-driver are missing: run scripts/test.sh")
        pytest.skip("needs chromium and chromium-driver")
    driven = chromium.start()
    yield driven
    driven.quit()


def wait_for(condition: Callable[[], Any], seconds: float = 30.0) -> Any:
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, "the page did not get there"
        time.sleep(0.02)
    return value


@pytest.fixture
def opened(browser: Any, page: Path) -> Any:
    browser.get(page.as_uri())
    wait_for(lambda: browser.execute_script("return document.documentElement.dataset.ready"))
    yield browser
    errors = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert errors == []


def point(browser: Any, x: float, y: float) -> None:
    """Moves the mouse, as a person does."""
    from selenium.webdriver.common.actions.action_builder import ActionBuilder

    action = ActionBuilder(browser)
    action.pointer_action.move_to_location(round(x), round(y))
    action.perform()


def lit(browser: Any) -> tuple[set[str], set[str]]:
    """Names of the pieces that are lit in the model, and on the sheet."""
    return tuple(
        set(names.split())
        for names in browser.execute_script(
            "return [document.getElementById('canvas').dataset.lit, "
            "[...document.querySelectorAll('.piece-lit')].map(g => g.id).join(' ')]"
        )
    )


def picture(browser: Any) -> np.ndarray:
    """Of the model, #rows by #columns by 3."""
    image = Image.open(BytesIO(browser.find_element("id", "canvas").screenshot_as_png))
    return np.asarray(image.convert("RGB")).astype(int)


def test_the_page_is_one_file(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert page.stat().st_size < PAGE_LIMIT
    assert "b\u00e4r &lt;&amp;&gt;" in text
    for remote in ('src="', "<link", "@import", "fetch(", "{{"):
        assert remote not in text.split('<script id="data"')[0] + text.split("<script>")[-1]
    assert "Permission is hereby granted" in text, "three.js without its licence"


# Where the mouse is on piece 3 of the sheet.
ON_THE_THIRD = (
    "const p = document.getElementById('P03-cut'); const b = p.getBBox();"
    "const m = p.getScreenCTM();"
    "for (let i = 1; i < 40; ++i) for (let k = 1; k < 40; ++k) {"
    "  const q = new DOMPoint(b.x + b.width * i / 40, b.y + b.height * k / 40);"
    "  const s = q.matrixTransform(m); const x = Math.round(s.x); const y = Math.round(s.y);"
    "  if (document.elementFromPoint(x, y) === p) return [x, y]; }"
)


def test_a_piece_is_lit_in_both_views(opened: Any) -> None:
    before = picture(opened)
    point(opened, *opened.execute_script(ON_THE_THIRD))
    wait_for(lambda: lit(opened) == ({"P03"}, {"P03"}))
    assert "P03" in opened.find_element("id", "about").text
    rows = opened.find_elements("css selector", "#piece-list .lit")
    assert [row.text for row in rows] == ["P03"]
    # On the model it has turned yellow, or lies on the other side.
    changed = np.abs(picture(opened) - before).sum(axis=2) > 30
    canvas = opened.find_element("id", "canvas").rect
    seen = set()
    for y in range(round(canvas["y"]) + 20, round(canvas["y"] + canvas["height"]), 90):
        for x in range(round(canvas["x"]) + 20, round(canvas["x"] + canvas["width"]), 90):
            point(opened, x, y)
            model, sheet = wait_for(lambda: (both := lit(opened))[0] == both[1] and both)
            assert model == sheet and len(model) <= 1
            seen |= model
            if model == {"P03"}:
                assert changed[y - round(canvas["y"]), x - round(canvas["x"])]
    assert len(seen) >= 3, "the mouse finds no pieces on the model"


def test_steps_are_played_forwards_and_back(opened: Any) -> None:
    count = opened.execute_script("return DATA.steps.length")
    visible = "return model.meshes.filter(m => m.group.visible).length"
    pieces = opened.execute_script("return DATA.pieces.length")
    shown = []
    for number in range(1, count + 1):
        opened.find_element("id", "next").click()
        text = opened.find_element("id", "step-text").text
        assert text.startswith(f"Step {number} of {count}.")
        wait_for(lambda: not opened.execute_script("return model.waiting"))
        shown.append(opened.execute_script(visible))
    assert shown == sorted(shown) and shown[0] < shown[-1] == pieces
    assert not opened.find_element("id", "next").is_enabled()
    assert "stuff it" in opened.find_element("id", "step-text").text
    opened.find_element("id", "back").click()
    assert f"Step {count - 1} of" in opened.find_element("id", "step-text").text
    assert opened.execute_script("return model.flight.every(f => f >= 0 && f <= 1)")


def test_a_seam_shows_both_sides(opened: Any) -> None:
    button = opened.find_elements("css selector", "#seam-list button")[0]
    button.click()
    assert len(opened.find_elements("css selector", "#paper .side-lit")) == 2
    wait_for(lambda: opened.execute_script("return model.seams[0].every(line => line.visible)"))
    about = opened.find_element("id", "about").text
    assert "Seam 1" in about and "mm" in about and "allowance 7 mm" in about


def test_colours_of_strain_show_most_of_it(opened: Any) -> None:
    percent, at_the_ends = opened.execute_script(
        "const all = DATA.pieces.flatMap((p) => [...numbers(p.strain, Uint8Array)]);"
        "return [100 * DATA.strain, all.filter((s) => s <= 1 || s >= 255).length / all.length]"
    )
    assert percent in (5, 10, 20, 50, 100) and at_the_ends < 0.2
    colors = opened.find_element("id", "colors")
    opened.execute_script(
        "arguments[0].value = 'byStrain'; arguments[0].dispatchEvent(new Event('change'))", colors
    )
    legend = opened.find_element("id", "legend").text
    assert f"compressed {percent:g} %" in legend and f"stretched {percent:g} %" in legend


def test_page_numbers_lie_above_the_pieces(opened: Any) -> None:
    assert opened.execute_script(
        "const numbers = [...document.querySelectorAll('#paper .number')];"
        "const pieces = [...document.querySelectorAll('#paper .outline')];"
        "const above = Node.DOCUMENT_POSITION_FOLLOWING;"
        "return numbers.length === DATA.pages.length && numbers.every((n) =>"
        "  pieces.every((p) => p.compareDocumentPosition(n) & above))"
    )


def test_measuring_is_true(opened: Any) -> None:
    opened.find_element("id", "measure").click()
    ends = opened.execute_script(
        "const m = sheet.svg.getScreenCTM(); const p = DATA.pages[0];"
        "return [[p[0] + 20, p[1] + 30], [p[0] + 120, p[1] + 30]].map(([x, y]) => {"
        "  const s = new DOMPoint(x, y).matrixTransform(m); return [s.x, s.y]; })"
    )
    from selenium.webdriver.common.action_chains import ActionChains

    for x, y in ends:
        point(opened, x, y)
        ActionChains(opened).click().perform()
    shown = float(opened.find_element("id", "distance").text.split()[0])
    pixel = 100 / (ends[1][0] - ends[0][0])
    assert shown == pytest.approx(100, abs=2 * pixel)


def test_everything_has_a_name_and_a_key(opened: Any) -> None:
    unnamed = opened.execute_script(
        "return [...document.querySelectorAll('button, input, select, [role=img], [role=group]')]"
        ".filter(e => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length))"
        ".map(e => e.outerHTML.slice(0, 80))"
    )
    assert unnamed == []
    from selenium.webdriver.common.keys import Keys

    canvas = opened.find_element("id", "canvas")
    place = "return model.camera.position.toArray()"
    before = opened.execute_script(place)
    canvas.send_keys(Keys.ARROW_LEFT)
    assert opened.execute_script(place) != before


def test_all_of_it_works_by_keyboard(opened: Any) -> None:
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys

    def focus(selector: str) -> str:
        """With Tab alone; returns what is said of it."""
        for _ in range(200):
            ActionChains(opened).send_keys(Keys.TAB).perform()
            if opened.execute_script(
                "return document.activeElement.matches(arguments[0])", selector
            ):
                return opened.execute_script("return document.getElementById('about').textContent")
        raise AssertionError(f"Tab does not reach {selector}")

    def press(*keys: str) -> None:
        ActionChains(opened).send_keys(*keys).perform()

    distance = "return model.camera.position.distanceTo(model.controls.target)"
    width = "return sheet.view.width"
    visible = "return model.meshes.filter(m => m.group.visible).length"
    focus("#theme")
    theme = "return document.documentElement.dataset.theme"
    before = opened.execute_script(theme)
    press(Keys.ENTER)
    assert opened.execute_script(theme) != before
    press(Keys.ENTER)
    focus("#explode")
    place = "return model.meshes[0].group.position.toArray()"
    before = opened.execute_script(place)
    press(Keys.END)
    wait_for(lambda: opened.execute_script(place) != before)
    press(Keys.HOME)
    focus("#canvas")
    before = opened.execute_script(distance)
    press("+")
    assert opened.execute_script(distance) < before
    press("-")
    focus("#paper")
    before = opened.execute_script(width)
    press("+")
    assert opened.execute_script(width) < before
    press("-")
    focus("#next")
    press(Keys.SPACE)
    wait_for(lambda: not opened.execute_script("return model.waiting"))
    assert opened.execute_script(visible) < opened.execute_script("return DATA.pieces.length")
    focus("#step-list button")
    press(Keys.ENTER)
    assert opened.execute_script("return state.step") == 1
    assert "P01" in focus("#piece-list button")
    wait_for(lambda: lit(opened) == ({"P01"}, {"P01"}))
    assert "Seam 1:" in focus("#seam-list button")
    opened.execute_script("goTo(0)")


def test_steps_play_by_themselves(opened: Any) -> None:
    opened.find_element("id", "play").click()
    wait_for(lambda: opened.execute_script("return state.step") == 2)
    opened.find_element("id", "play").click()
    assert opened.find_element("id", "play").get_attribute("aria-pressed") == "false"


def test_fingers_choose_pieces_and_zoom(opened: Any) -> None:
    def touch(kind: str, *places: tuple[float, float]) -> None:
        points = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(places)]
        opened.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    x, y = opened.execute_script(ON_THE_THIRD)
    touch("touchStart", (x, y))
    touch("touchEnd")
    wait_for(lambda: lit(opened) == ({"P03"}, {"P03"}))
    width = "return sheet.view.width"
    before = opened.execute_script(width)
    touch("touchStart", (x, y), (x + 40, y))
    touch("touchMove", (x, y), (x + 80, y))
    touch("touchEnd")
    wait_for(lambda: opened.execute_script(width) < 0.8 * before)


@pytest.mark.parametrize("width", [390, 1280])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_it_fits_small_and_large_screens(opened: Any, width: int, theme: str) -> None:
    size = {"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 800}
    opened.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    opened.execute_script("setTheme(arguments[0])", theme)
    try:
        assert opened.execute_script("return document.documentElement.scrollWidth") <= width
        colors = opened.execute_script(
            "const s = getComputedStyle(document.querySelector('section'));"
            "return [s.backgroundColor, getComputedStyle(document.body).color]"
        )
        back, ink = (sum(map(int, c.strip("rgb()").split(",")[:3])) for c in colors)
        assert abs(back - ink) > 3 * 128 and (back > ink) == (theme == "light")
    finally:
        opened.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def test_without_webgl_the_rest_works(page: Path, browser: Any) -> None:
    off = "HTMLCanvasElement.prototype.getContext = () => null;"
    script = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": off})
    try:
        browser.get(page.as_uri())
        wait_for(lambda: browser.execute_script("return document.documentElement.dataset.ready"))
        assert "WebGL 2 is off" in browser.find_element("id", "view").text
        browser.find_element("id", "next").click()
        assert browser.find_element("id", "step-text").text.startswith("Step 1 of")
        point(browser, *browser.execute_script(ON_THE_THIRD))
        wait_for(lambda: "P03" in browser.find_element("id", "about").text)
        assert [e for e in browser.get_log("browser") if e["level"] == "SEVERE"] == []
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)


def test_firefox_shows_the_page(page: Path, tmp_path: Path) -> None:
    for program in ("firefox-esr", "Xvfb"):
        if not shutil.which(program):
            if os.environ.get("DEVSEG_HOST_TESTS") == "required":
                pytest.fail(f"{program} is missing: run scripts/test.sh")
            pytest.skip(f"needs {program}")
    with firefox.Firefox(tmp_path) as fox:
        fox.open(page.as_uri())
        wait_for(lambda: fox.run("return document.documentElement.dataset.ready"))
        x, y, width, height = fox.run(
            "const b = document.getElementById('canvas').getBoundingClientRect();"
            "return [b.x, b.y, b.width, b.height].map(Math.round)"
        )
        model = fox.picture()[y : y + height, x : x + width]
        assert len(np.unique(model.reshape(-1, 3), axis=0)) > 50, "there is no model to see"
        fox.point(*fox.run(ON_THE_THIRD))
        lit_names = (
            "return [document.getElementById('canvas').dataset.lit, "
            "[...document.querySelectorAll('.piece-lit')].map(g => g.id).join(' ')]"
        )
        wait_for(lambda: fox.run(lit_names) == ["P03", "P03"])
        fox.point(x + width / 2, y + height / 2)
        wait_for(lambda: (names := fox.run(lit_names))[0] == names[1] not in ("", "P03"))
        count = fox.run("return DATA.steps.length")
        for number in range(1, count + 1):
            fox.run("document.getElementById('next').click()")
            text = fox.run("return document.getElementById('step-text').textContent")
            assert text.startswith(f"Step {number} of {count}.")
        assert fox.errors == []


def test_the_model_is_seen_within_a_second(pymeshlab: Any, browser: Any, tmp_path: Path) -> None:
    ms = pymeshlab.MeshSet()
    ms.create_sphere(radius=1.0, subdiv=6)
    ms.compute_segmentation_variational_shape_approximation_per_face(charts_number=6)
    ms.compute_seams_charts_to_disks_per_edge()
    ms.compute_texcoord_parametrization_charts_per_wedge(pack=False)
    faces = ms.current_mesh().face_number()
    assert faces >= 70_000
    path = tmp_path / "large.html"
    ms.apply_filter("export_pattern", output_file=str(path), preset="Sewing", mm_per_unit=SCALE)
    assert path.stat().st_size < PAGE_LIMIT
    seen = []
    for _ in range(5):  # a busy machine is late now and then
        browser.get(path.as_uri())
        wait_for(lambda: browser.execute_script("return document.documentElement.dataset.ready"))
        mark = "return performance.getEntriesByName('model')[0].startTime"
        seen.append(browser.execute_script(mark))
    assert min(seen) < 1000
