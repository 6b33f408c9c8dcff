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
    names = _names(results)
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
    for number, (kind, section) in enumerate(zip(kinds, sections, strict=True), 1):
        seams = [s for s, step in enumerate(done, 1) if step == number]
        if KINDS[kind] == "close" and openings:
            seams = [int(next(closing)["seam"])]
        pieces = sorted({side[s - 1] for s in seams for side in (first, second)})
        steps.append(
            {
                "step": number,
                "kind": KINDS[kind],
                "section": _letters(section),
                "seams": seams,
                "pieces": [names[piece] for piece in pieces],
            }
        )
    return {
        "sections": {
            name: _letters(section)
            for name, section in zip(names, _whole(results["piece_section"]), strict=True)
        },
        "steps": steps,
        "openings": openings,
    }


def needs(results: Mapping[str, Any], parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Areas, lengths, time, stuffing and paper.

    Args:
        results: of the export filter.
        parameters: that it was given; they name the materials.
    """
    usual = str(parameters.get("material", "")).split(",")[0].strip()
    other = {}
    for entry in filter(None, str(parameters.get("piece_materials", "")).split(",")):
        piece, material = entry.split("=", 1)
        other[piece.strip()] = material.strip()
    areas: dict[str, float] = {}
    for name, area in zip(_names(results), results["piece_material_mm2"], strict=True):
        material = other.get(name, usual) or "any"
        areas[material] = areas.get(material, 0.0) + float(area)
    return {**{name: results[name] for name in NEEDS}, "materials_mm2": areas}


def _names(results: Mapping[str, Any]) -> list[str]:
    """Of the pieces, in their order."""
    count = int(results["pieces_number"])
    width = max(2, len(str(count)))
    return [f"P{piece:0{width}d}" for piece in range(1, count + 1)]


def _whole(values: Any) -> list[int]:
    return [int(value) for value in values]


def _letters(section: int) -> str:
    name, rest = "", section + 1
    while rest > 0:
        rest, letter = divmod(rest - 1, 26)
        name = chr(ord("A") + letter) + name
    return name
