"""Lengths and pages as people write them."""

from __future__ import annotations

import argparse

import pytest

from devseg import lengths
from devseg.cli import main

PAGES = {
    "none": "none",
    "A4": "a4",
    "letter": "letter",
    "a4-portrait": "210x297",
    "a4-landscape": "297x210",
    "a2": "420x594",
    "a1": "594x841",
    "legal": "215.9x355.6",
    "tabloid-landscape": "431.8x279.4",
    "600x400": "600x400",
    "24x36in": "609.6x914.4",
    "60.5 x 80cm": "605x800",
}


@pytest.mark.parametrize("text", PAGES)
def test_pages(text: str) -> None:
    assert lengths.page(text) == PAGES[text]


@pytest.mark.parametrize(
    "text", ["a9", "a4-across", "none-landscape", "0x100", "100", "10x20x30", "1e9x1", "x", ""]
)
def test_wrong_pages_end_before_any_work(text: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["run", "missing.obj", "-o", "out", "--page", text])
    assert stopped.value.code == 2
    error = capfd.readouterr().err
    assert f"found '{text}'" in error and "tabloid" in error and "missing.obj" not in error


@pytest.mark.parametrize(
    ("text", "mm"), [("10in", 254), ('2.5"', 63.5), ("25 cm", 250), ("1ft", 304.8), ("7MM", 7)]
)
def test_sizes_have_a_unit(text: str, mm: float) -> None:
    assert lengths.size(text) == pytest.approx(mm)
    assert lengths.millimetres()(text) == pytest.approx(mm)


@pytest.mark.parametrize("text", ["10", "in", "-3mm", "0in", "nan mm", "3 yards", ""])
def test_what_is_no_size(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="such as 250mm"):
        lengths.size(text)


def test_plain_numbers_are_millimetres() -> None:
    assert lengths.millimetres()("6") == 6
    with pytest.raises(argparse.ArgumentTypeError, match="found '-1'"):
        lengths.millimetres()("-1")


def test_shown_without_powers_of_ten() -> None:
    assert lengths.shown([20000, 0.1, 101.6]) == "20,000 x 0.1 x 101.6 mm"
