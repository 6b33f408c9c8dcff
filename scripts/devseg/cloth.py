"""Materials, grain and rolls of cloth on the command line, and what the export tells about them."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from devseg.lengths import length, millimetres, number
from devseg.methods import EFFORTS

GRAINS = {
    "best": "Best fit",
    "longest": "Longest side",
    "up": "Up",
    "texture-v": "Texture v",
    "free": "Free",
}
# Formats that hold a marker.
MARKER_FORMATS = ("svg", "pdf", "dxf")
# Options that shape a marker and nothing else, and the export's parameters that do.
MARKER_OPTIONS = ("fabric_width_mm", "selvedge_mm", "fold", "nap", "copies", "piece_gap_mm")
MARKER_PARAMETERS = (*MARKER_OPTIONS, "effort")
# Those that shape the pieces.
PIECE_PARAMETERS = ("material", "kerf_mm", "thickness_mm", "bend_radius_mm", "k_factor")
# Heights of which each gets files of its own; no parameter of the export.
APART = "sizes_apart"
_GATHERED_MM = 0.5  # sides of a seam that differ by more are told
_OF_PIECE = {
    "along": "piece_strain_along",
    "along_95": "piece_strain_along_95",
    "across": "piece_strain_across",
    "across_95": "piece_strain_across_95",
    "limit_use": "piece_limit_use",
    "worst_use": "piece_worst_use",
}


def add_options(group: argparse._ArgumentGroup) -> None:
    """The options of materials and markers."""
    group.add_argument(
        "--material",
        type=material,
        metavar="NAME|FILE",
        help="cotton, fleece, leather and others, or a JSON file: limits of strain, nap, allowance",
    )
    group.add_argument(
        "--grain",
        type=grain,
        metavar="G",
        help="best, longest, up, texture-v, free, or degrees from the texture's v; default: best",
    )
    group.add_argument(
        "--thickness-mm", type=millimetres(), metavar="T", help="pieces get shorter at bends"
    )
    group.add_argument(
        "--bend-radius-mm", type=millimetres(), metavar="R", help="inner radius of sharp bends"
    )
    group.add_argument(
        "--k-factor", type=_k_factor, metavar="K", help="neutral line of bends, from 0 to 1"
    )
    group.add_argument("--kerf-mm", type=millimetres(), metavar="K", help="width of the cut")
    group.add_argument(
        "--fabric-width-mm",
        type=millimetres(),
        metavar="W",
        help="write NAME_marker: all pieces on a roll of cloth of this width",
    )
    group.add_argument(
        "--selvedge",
        type=millimetres(),
        dest="selvedge_mm",
        metavar="MM",
        help="at each side of the cloth, left empty; default: 0",
    )
    group.add_argument(
        "--sizes",
        type=sizes,
        metavar="A,B,C",
        help="heights of the finished object in mm, over each other in one file",
    )
    group.add_argument(
        "--sizes-apart",
        action="store_true",
        help="a file NAME_A for each of the sizes instead",
    )
    group.add_argument("--copies", type=_copies, metavar="N", help="of all pieces; default: 1")
    group.add_argument(
        "--piece-gap-mm", type=millimetres(), metavar="D", help="on the cloth; default: 3"
    )
    for name, text in (
        ("fold", "the cloth lies double, folded along its length"),
        ("nap", "all pieces lie the same way round"),
    ):
        group.add_argument(f"--{name}", action="store_true", default=None, help=text)


def material(text: str) -> str:
    """The export's words for a material: a name, or what a JSON file says.

    The file is one object: "like" names the material that it is like, all other keys are values of
    their own, such as {"like": "fleece", "warp": 0.12}.
    """
    if not text.lower().endswith(".json"):
        return text
    expected = 'expected a JSON object such as {"like": "fleece", "warp": 0.12}'
    try:
        values = json.loads(Path(text).read_text(encoding="utf-8"))
    except OSError as error:
        raise argparse.ArgumentTypeError(f"cannot read {text} ({error.strerror})") from error
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{expected}, found no JSON in {text}") from error
    if not isinstance(values, dict) or not isinstance(values.get("like"), str):
        raise argparse.ArgumentTypeError(f'{expected}, found no "like" in {text}')
    words = [values.pop("like")]
    for key, value in values.items():
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise argparse.ArgumentTypeError(f"{expected}, found {key}: {value!r} in {text}")
        words.append(f"{key}={float(value):.10g}")
    return ", ".join(words)


def grain(text: str) -> dict[str, Any]:
    """The export's parameters for a grain: a word, or degrees."""
    if text in GRAINS:
        return {"grain": GRAINS[text]}
    angle = number(text)
    if not -180 <= angle <= 180:
        raise argparse.ArgumentTypeError(
            f"expected {', '.join(GRAINS)} or degrees from -180 to 180, found '{text}'"
        )
    return {"grain": "Angle", "grain_angle": angle}


def sizes(text: str) -> tuple[float, ...]:
    """Heights in mm, ascending."""
    found = [number(part) for part in text.split(",")]
    if not all(size > 0 for size in found) or len(set(found)) < len(found):
        raise argparse.ArgumentTypeError(
            f"expected heights in mm that differ, such as 200,250,300, found '{text}'"
        )
    return tuple(sorted(found))


def _copies(text: str) -> int:
    value = length(1)(text)
    if value != int(value) or value > 10_000:
        raise argparse.ArgumentTypeError(f"expected a whole number to 10000, found '{text}'")
    return int(value)


def _k_factor(text: str) -> float:
    value = number(text)
    if not 0 <= value <= 1:
        raise argparse.ArgumentTypeError(f"expected a share from 0 to 1, found '{text}'")
    return value


def parameters(args: argparse.Namespace) -> dict[str, Any]:
    """The parameters of the export that were given."""
    names = (*PIECE_PARAMETERS, *MARKER_OPTIONS)
    given = {name: getattr(args, name) for name in names if getattr(args, name) is not None}
    if "fabric_width_mm" in given:
        given["effort"] = EFFORTS[args.effort]
    if args.sizes:
        given["height_mm"] = args.sizes[-1]
        if args.sizes_apart:
            given[APART] = args.sizes
        else:
            given["sizes"] = ",".join(f"{size:.10g}" for size in args.sizes)
    return {**given, **(args.grain or {})}


def check(args: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    """Reports options of a marker that is not asked for, or that no format holds."""
    if args.sizes_apart and not args.sizes:
        parser.error("--sizes-apart needs --sizes")
    if args.sizes and (args.height_mm or args.longest_mm or args.mm_per_unit):
        parser.error("--sizes gives the height: leave --height-mm and its like out")
    given = [name for name in MARKER_OPTIONS if getattr(args, name) is not None]
    if given and not args.fabric_width_mm:
        option = "selvedge" if given[0] == "selvedge_mm" else given[0].replace("_", "-")
        parser.error(f"--{option} needs the width of the cloth: give --fabric-width-mm")
    if args.fabric_width_mm and not set(MARKER_FORMATS) & set(args.formats):
        parser.error("--fabric-width-mm needs --formats with svg, pdf or dxf")


def split(pattern: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The parameters of the pattern's own files, and those of the marker (or none)."""
    plain = {name: value for name, value in pattern.items() if name not in MARKER_PARAMETERS}
    if not pattern.get("fabric_width_mm"):
        return plain, {}
    left_out = ("page", "page_margin_mm", "sizes", APART)
    return plain, {k: v for k, v in pattern.items() if k not in left_out}


def written(pattern: Mapping[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    """The pattern files to write: what follows NAME, and the parameters of each."""
    apart = pattern.get(APART)
    if not apart:
        yield "", dict(pattern)
        return
    rest = {name: value for name, value in pattern.items() if name not in (APART, "sizes")}
    for size in apart:
        yield f"_{size:g}", {**rest, "height_mm": size}


def strains(results: Mapping[str, Any], material_text: str) -> dict[str, Any]:
    """What NAME.json tells of the strain of each piece, and of seams that are gathered."""
    count = int(results["pieces_number"])
    width = max(2, len(str(count)))
    pieces: dict[str, Any] = {}
    for i in range(count):
        told: dict[str, Any] = {key: float(results[of][i]) for key, of in _OF_PIECE.items()}
        told["within_limits"] = told["limit_use"] <= 1 and told["worst_use"] <= 2
        told["worst_place_mm"] = [float(results[f"piece_worst_{axis}_mm"][i]) for axis in "xy"]
        pieces[f"P{i + 1:0{width}d}"] = told
    eases = {str(s): float(ease) for s, ease in enumerate(results["seam_ease_mm"], 1)}
    return {
        "material": material_text,
        "pieces_above_limits": int(results["pieces_above_limits_number"]),
        "pieces": pieces,
        "gathered_seams_mm": {s: ease for s, ease in eases.items() if ease > _GATHERED_MM},
    }


def fabrics(pattern: Mapping[str, Any]) -> list[str]:
    """The names of the materials of a model that is of several."""
    names = pattern.get("material_names")
    return str(names).split(", ") if names else []


def materials(results: Mapping[str, Any], names: list[str]) -> dict[str, Any]:
    """For each material the area inside its cut lines and its pieces."""
    count = int(results["pieces_number"])
    width = max(2, len(str(count)))
    told: dict[str, Any] = {
        name: {"area_mm2": float(area), "pieces": []}
        for name, area in zip(names, results["fabric_area_mm2"], strict=True)
    }
    for i, fabric in enumerate(results["piece_fabric"]):
        told[names[int(fabric)]]["pieces"].append(f"P{i + 1:0{width}d}")
    return told


def marker(results: Mapping[str, Any], names: list[str]) -> dict[str, Any]:
    """What NAME.json tells of the marker; of each strip where there are several materials."""
    strips = {
        name: {"length_mm": float(length), "use": float(use)}
        for name, length, use in zip(
            names, results["fabric_lengths_mm"], results["fabric_uses"], strict=bool(names)
        )
    }
    return {
        **({"strips": strips} if names else {}),
        "length_mm": float(results["fabric_length_mm"]),
        "use": float(results["fabric_use"]),
        "single_layer_pieces": int(results["single_layer_pieces_number"]),
    }
