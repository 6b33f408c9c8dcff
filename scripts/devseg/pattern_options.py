"""The options of pattern files on the command line, and the filter parameters they set."""

from __future__ import annotations

import argparse
from typing import Any

from devseg import cloth
from devseg.lengths import length, millimetres, page

EXPORT_FILTER = "export_pattern"
# Formats that the export filter writes.
PATTERN_FORMATS = ("svg", "pdf", "dxf", "html", "png")
PRESETS = {"plain": "Plain", "sewing": "Sewing", "papercraft": "Papercraft", "laser": "Laser"}
DXF_KINDS = {"auto": "Automatic", "cutter": "Cutter", "apparel": "Apparel"}

TEXTS = {"text": "Text", "paths": "Paths"}
GROUPS = {"layer": "Layer", "piece": "Piece"}
TABS = {"one": "One", "both": "Both", "alternating": "Alternating", "none": "None"}
FOLD_MARKS = {"lines": "Lines", "outside": "Outside", "none": "None"}
TEXTURES = {"none": "None", "auto": "Automatic"}
NOTCHES = {"slit": "Slit", "triangle": "Triangle"}
CORNERS = {"miter": "Miter", "bevel": "Bevel", "round": "Round"}


def _numbers(text: str) -> str:
    """Numbers of seams, from 1 on, with commas."""
    words = [word.strip() for word in text.split(",")]
    if not all(word.isdecimal() and int(word) > 0 for word in words):
        raise argparse.ArgumentTypeError(f"expected numbers of seams such as 3,7, found '{text}'")
    return ",".join(words)


def add_pattern_options(parser: argparse.ArgumentParser) -> None:
    """The options that shape pattern files, beside the scale."""
    group = parser.add_argument_group("pattern files (svg, pdf, dxf, png)")
    group.add_argument("--preset", choices=PRESETS, help="what to make; default: plain")
    group.add_argument(
        "--page",
        type=page,
        metavar="PAGE",
        help="none, letter, legal, tabloid, a4 to a0 (also a4-landscape), WxH in mm, or such as "
        "24x36in; default: none",
    )
    group.add_argument("--page-margin-mm", type=millimetres(), metavar="M", help="default: 10")
    group.add_argument(
        "--seam-allowance-mm", type=millimetres(), metavar="A", help="along seams; default: 0"
    )
    group.add_argument(
        "--hem-allowance-mm",
        type=millimetres(),
        metavar="A",
        help="along open borders; default: as seams",
    )
    group.add_argument(
        "--dart-allowance-mm",
        type=millimetres(),
        metavar="A",
        help="along darts; default: as seams",
    )
    group.add_argument(
        "--zip-seams", type=_numbers, metavar="N,M", help="numbers of the seams that get a zip"
    )
    group.add_argument(
        "--zip-allowance-mm", type=millimetres(), metavar="A", help="along them; default: as seams"
    )
    group.add_argument(
        "--notch-kind", choices=NOTCHES, help="a slit, or a triangle to cut out; default: slit"
    )
    group.add_argument(
        "--alike-mm",
        type=millimetres(),
        metavar="MM",
        help="pieces that differ by less get one outline, mirrored or not; default: 0, none",
    )
    group.add_argument(
        "--notch-spacing-mm",
        type=millimetres(),
        metavar="D",
        help="between notches; default: 0, none",
    )
    group.add_argument(
        "--fold-angle", type=length(), metavar="DEG", help="least angle of a fold; default: 3"
    )
    group.add_argument(
        "--fold-marks",
        choices=FOLD_MARKS,
        help="folds as lines, as strokes outside of the pieces, or not; default: lines",
    )
    group.add_argument(
        "--perforation",
        type=_perforation,
        metavar="CUT,GAP",
        help="folds as cuts with gaps, in mm such as 3,1, on a layer of their own",
    )
    group.add_argument(
        "--max-piece-mm",
        type=millimetres(),
        metavar="L",
        help="split larger pieces; default: 0, none",
    )
    group.add_argument(
        "--simplify-mm", type=millimetres(), metavar="T", help="of outlines; default: 0.1"
    )
    group.add_argument(
        "--curve-mm",
        type=millimetres(),
        metavar="T",
        help="outlines as curves; default: 0, none",
    )
    group.add_argument(
        "--corner-style", choices=CORNERS, help="corners of the allowance; default: miter"
    )
    group.add_argument(
        "--tab-depth-mm", type=millimetres(0.5), metavar="D", help="of glue tabs; default: 5"
    )
    group.add_argument(
        "--tabs",
        choices=TABS,
        help="sides of seams with glue tabs; default: one to fold, else none",
    )
    group.add_argument(
        "--texture",
        choices=TEXTURES,
        help="auto: print the textures of the model on the pieces (svg, pdf, png), else the "
        "colours of its faces, else those of its vertices; default: none",
    )
    group.add_argument(
        "--bleed",
        type=millimetres(),
        dest="bleed_mm",
        metavar="B",
        help="of the texture beyond the cut lines, at most 3; default: 2",
    )
    group.add_argument(
        "--group", choices=GROUPS, help="groups of an SVG: by operation or by piece; default: layer"
    )
    group.add_argument(
        "--text", choices=TEXTS, help="texts of an SVG, as outlines or not; default: text"
    )
    group.add_argument(
        "--sewing-mm-per-minute", type=length(), metavar="R", help="sewing rate; default: 100"
    )
    group.add_argument(
        "--stuffing-g-per-litre", type=length(), metavar="D", help="density; default: 30"
    )
    group.add_argument("--dxf", choices=DXF_KINDS, dest="dxf_kind", help="kind of DXF")
    _add_switches(group)
    cloth.add_options(parser.add_argument_group("materials and rolls of cloth"))


def _perforation(text: str) -> tuple[float, float]:
    """The type of an option: the lengths of the cuts and of the gaps between them, mm."""
    lengths = text.split(",")
    if len(lengths) != 2:
        raise argparse.ArgumentTypeError(
            f"expected the lengths of cuts and gaps in mm such as 3,1, found '{text}'"
        )
    return millimetres(0.1)(lengths[0]), millimetres(0.1)(lengths[1])


def _add_switches(group: argparse._ArgumentGroup) -> None:
    for name, text in (
        ("glue-tabs", "flaps to glue the pieces with"),
        ("fit-page", "cut pieces until each fits on a page"),
        ("border-tabs", "flaps along open borders of the model as well"),
        ("tab-shadows", "outlines of the flaps where they are glued"),
        ("fold-lines", "mountain and valley folds"),
        ("edge-numbers", "the number of each seam on both sides"),
        ("step-numbers", "the step of the assembly behind each seam number"),
        ("drill-marks", "a cross where each dart ends"),
        ("grain-line", "an arrow along the threads of the cloth"),
        ("mirror", "as seen from inside the model"),
        ("registration-marks", "marks by which a cutter finds what was printed"),
    ):
        group.add_argument(f"--{name}", action="store_true", help=text, default=None)
    group.add_argument(
        "--no-tiling", action="store_false", dest="tiling", default=None, help="refuse large pieces"
    )
    group.add_argument(
        "--no-labels", action="store_false", dest="labels", default=None, help="no piece names"
    )
    group.add_argument(
        "--no-frame", action="store_false", dest="frame", default=None, help="SVG, DXF: no frame"
    )
    group.add_argument(
        "--no-scale-check",
        action="store_false",
        dest="scale_check",
        default=None,
        help="SVG, DXF: no squares to check the scale with",
    )
    group.add_argument(
        "--no-cover", action="store_false", dest="cover", default=None, help="PDF: patterns only"
    )


_PARAMETERS = (
    "page",
    "page_margin_mm",
    "seam_allowance_mm",
    "hem_allowance_mm",
    "dart_allowance_mm",
    "zip_allowance_mm",
    "zip_seams",
    "drill_marks",
    "max_piece_mm",
    "simplify_mm",
    "curve_mm",
    "tab_depth_mm",
    "alike_mm",
    "notch_spacing_mm",
    "fold_angle",
    "glue_tabs",
    "border_tabs",
    "fit_page",
    "tab_shadows",
    "fold_lines",
    "edge_numbers",
    "grain_line",
    "mirror",
    "tiling",
    "cover",
    "labels",
    "frame",
    "step_numbers",
    "sewing_mm_per_minute",
    "stuffing_g_per_litre",
    "scale_check",
    "bleed_mm",
    "registration_marks",
)

# The option that sets a parameter of the export filter.
OPTION_OF = {
    **{
        name: f"--{name.replace('_', '-')}"
        for name in (
            *_PARAMETERS,
            "preset",
            "corner_style",
            "notch_kind",
            "group",
            "text",
            "tabs",
            "fold_marks",
            "texture",
        )
    },
    **{
        name: f"--{name.replace('_', '-')}"
        for name in ("grain", *cloth.PIECE_PARAMETERS, *cloth.MARKER_PARAMETERS)
    },
    "selvedge_mm": "--selvedge",
    "grain_angle": "--grain",
    **{name: f"--{name.replace('_', '-')}" for name in ("height_mm", "mm_per_unit")},
    "tiling": "--no-tiling",
    "labels": "--no-labels",
    "cover": "--no-cover",
    "frame": "--no-frame",
    "scale_check": "--no-scale-check",
    "dxf_kind": "--dxf",
    "perforation_mm": "--perforation",
    "perforation_gap_mm": "--perforation",
    "bleed_mm": "--bleed",
}

_CHOICES = {
    "preset": PRESETS,
    "dxf_kind": DXF_KINDS,
    "corner_style": CORNERS,
    "notch_kind": NOTCHES,
    "group": GROUPS,
    "text": TEXTS,
    "tabs": TABS,
    "fold_marks": FOLD_MARKS,
    "texture": TEXTURES,
}


def pattern_parameters(args: argparse.Namespace) -> dict[str, Any]:
    """The parameters of the export filter that were given."""
    given = {name: getattr(args, name) for name in _PARAMETERS}
    parameters = {name: value for name, value in given.items() if value is not None}
    for name, values in _CHOICES.items():
        if (value := getattr(args, name)) is not None:
            parameters[name] = values[value]
    if args.perforation:
        parameters["perforation_mm"], parameters["perforation_gap_mm"] = args.perforation
    parameters.update(cloth.parameters(args))
    if args.height_mm:
        parameters["height_mm"] = args.height_mm
    elif args.mm_per_unit:
        parameters["mm_per_unit"] = args.mm_per_unit
    return parameters
