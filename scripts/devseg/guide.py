"""The order of assembly and what it needs, from the numbers that the export filter returns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

KINDS = {1: "darts", 2: "join", 3: "tube", 4: "attach", 5: "close"}
NEEDS = (
    "material_mm2",
    "seams_mm",
    "hems_mm",
    "sewing_minutes",
    "stuffing_litres",
    "stuffing_g",
    "paper_sheets_number",
)


def assembly(results: Mapping[str, Any]) -> dict[str, Any]:
    """Sections, steps and openings by name, as NAME.json holds them.

    Args:
        results: of the export filter.
    """
    width = max(2, len(str(int(results["pieces_number"]))))
    first, second = _whole(results["seam_first_piece"]), _whole(results["seam_second_piece"])
    done = _whole(results["seam_step"])
    openings = [
        {"seam": int(seam), "from_mm": float(start), "to_mm": float(end)}
        for seam, start, end in zip(
            results["opening_seam"],
            results["opening_from_mm"],
            results["opening_to_mm"],
            strict=True,
        )
    ]
    steps = []
    closing = iter(openings)
    kinds, sections = _whole(results["step_kind"]), _whole(results["step_section"])
    seams_of: dict[int, list[int]] = {}
    for seam, step in enumerate(done, 1):
        seams_of.setdefault(step, []).append(seam)
    for number, (kind, section) in enumerate(zip(kinds, sections, strict=True), 1):
        seams = seams_of.get(number, [])
        if KINDS[kind] == "close" and openings:
            seams = [int(next(closing)["seam"])]
        pieces = sorted({side[s - 1] for s in seams for side in (first, second)})
        steps.append(
            {
                "step": number,
                "kind": KINDS[kind],
                "section": _letters(section),
                "seams": seams,
                "pieces": [f"P{piece + 1:0{width}d}" for piece in pieces],
            }
        )
    return {
        "sections": {
            f"P{piece + 1:0{width}d}": _letters(section)
            for piece, section in enumerate(_whole(results["piece_section"]))
        },
        "steps": steps,
        "openings": openings,
    }


def needs(results: Mapping[str, Any]) -> dict[str, Any]:
    """Areas, lengths, time, stuffing and paper."""
    return {name: results[name] for name in NEEDS}


def _whole(values: Any) -> list[int]:
    return [int(value) for value in values]


def _letters(section: int) -> str:
    name, rest = "", section + 1
    while rest > 0:
        rest, letter = divmod(rest - 1, 26)
        name = chr(ord("A") + letter) + name
    return name
