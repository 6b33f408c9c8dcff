"""What `devseg run` takes: its options, and what they ask of the pipeline."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from devseg import cloth, given
from devseg.lengths import length, millimetres, number, size
from devseg.methods import EFFORTS, FLATTENINGS, METHOD_OPTIONS, METHODS, SMOOTH_METHODS
from devseg.pattern_options import (
    PATTERN_FORMATS,
    PRESETS,
    add_pattern_options,
    pattern_parameters,
)

if TYPE_CHECKING:
    from devseg.pipeline import RunOptions

# Words of --deform and the values of the filter's parameter "deform".
DEFORM = {"auto": "Automatic", "always": "Always", "never": "Never"}
# Rims of holes in scans have fewer edges, those of sleeves and necks more.
HOLE_EDGES = 100
FORMATS = (*PATTERN_FORMATS, "ply", "obj")


def add_run_options(parser: argparse.ArgumentParser) -> None:
    """The options of `devseg run` beside its inputs and its folder."""
    parser.add_argument("--method", choices=METHODS, default="dcharts", help="default: dcharts")
    parser.add_argument(
        "--charts",
        type=_charts,
        metavar="N",
        help="number of charts to start from, or auto: the fewest within the bounds (dcharts)",
    )
    for name, help_text in (
        ("--max-l2-stretch", "of all charts together; implies --charts auto (dcharts)"),
        ("--max-linf-stretch", "at the worst spot; implies --charts auto (dcharts)"),
    ):
        parser.add_argument(name, type=_stretch, metavar="S", help=help_text)
    parser.add_argument(
        "--max-fitting-error", type=_positive, metavar="E", help="how far from developable"
    )
    parser.add_argument(
        "--slit-threshold", type=length(), metavar="T", help="width of the gaps that are closed"
    )
    parser.add_argument(
        "--target-faces",
        type=integer(4),
        metavar="N",
        help="simplify the mesh to N faces first; people fold tens of edges, not thousands",
    )
    parser.add_argument(
        "--close-holes",
        type=integer(3),
        nargs="?",
        const=HOLE_EDGES,
        metavar="N",
        help=f"close holes of at most N edges first; default of N: {HOLE_EDGES}",
    )
    parser.add_argument(
        "--deform",
        choices=DEFORM,
        default="auto",
        help="whether vertices move until charts unfold exactly: always, never (papercraft: exact "
        "nets instead), or auto, with papercraft but for models of few faces; default: auto",
    )
    parser.add_argument(
        "--max-net-faces", type=integer(1), metavar="N", help="of nets (papercraft); default: any"
    )
    parser.add_argument("--max-iterations", type=integer(1), metavar="N", help="at most N rounds")
    parser.add_argument("--seed", type=integer(0), metavar="N", help="of the random choices")
    parser.add_argument(
        "--flatten",
        choices=FLATTENINGS,
        help="default: symmetric-dirichlet; lpfb with --method plush, and where --material bounds "
        "the strain of charts",
    )
    parser.add_argument(
        "--seams",
        choices=("smooth", "edges"),
        help="smooth curves, which split faces, or edges of the mesh; default: smooth in patterns "
        f"to sew and to cut by {', '.join(SMOOTH_METHODS)}, else edges, also "
        "where --material bounds the strain of patches",
    )
    parser.add_argument(
        "--formats",
        type=_formats,
        default=("svg", "ply"),
        metavar="LIST",
        help=f"of {','.join(FORMATS)}; default: svg,ply",
    )
    _add_input_options(parser)
    given.add_options(parser)
    add_pattern_options(parser)
    parser.add_argument(
        "--effort",
        choices=EFFORTS,
        default="normal",
        help="of packing texture coordinates, and of markers: fast takes milliseconds, best "
        "seconds; default: normal",
    )
    parser.add_argument(
        "--no-picture", action="store_false", dest="picture", help="write no NAME.png"
    )
    parser.add_argument(
        "--weld",
        type=_weld,
        default=0.0,
        metavar="on|off|SHARE",
        help="join border vertices at the same place where that closes open edges (on), or within "
        "a share of the size up to 0.01, or not (off); default: on",
    )
    parser.add_argument(
        "--keep-texcoords",
        action="store_true",
        help="PLY: the file's own texture coordinates as well, as texcoord_before",
    )
    parser.add_argument(
        "--json", action="store_true", help="print the results as JSON (a list for several inputs)"
    )


def _add_input_options(parser: argparse.ArgumentParser) -> None:
    scale = parser.add_argument_group("size of the finished object").add_mutually_exclusive_group()
    for side, help_text in (
        ("height", "along the axis that is up"),
        ("longest", "its longest side"),
    ):
        scale.add_argument(f"--{side}-mm", type=_size_mm, metavar="L", help=help_text)
        scale.add_argument(
            f"--{side}", type=size, dest=f"{side}_mm", metavar="L", help="such as 250mm or 10in"
        )
    scale.add_argument(
        "--mm-per-unit",
        type=_positive,
        metavar="S",
        help="size of a model unit; default: as 3mf, dae and gltf say, else 1",
    )
    parser.add_argument(
        "--up",
        choices=("y", "z"),
        help="axis of the file that points up; default: as 3mf, dae and gltf say, else y",
    )
    parser.add_argument(
        "--object",
        action="append",
        default=[],
        dest="objects",
        metavar="NAME",
        help="take this object of the file; may be given again; default: all",
    )
    parser.add_argument(
        "--component",
        type=integer(1),
        metavar="N",
        help="take this connected component, the largest is 1; default: all",
    )
    parser.add_argument(
        "--list-objects", action="store_true", help="only print the objects of the file"
    )


def integer(least: int) -> Callable[[str], int]:
    """The type of an option: a whole number, not below `least`."""

    def integer(text: str) -> int:
        value = int(text) if text.lstrip("+-").isdecimal() else None
        # The host stores integers in 32 bits.
        if value is None or not least <= value < 2**31:
            raise argparse.ArgumentTypeError(
                f"expected a whole number of at least {least}, found '{text}'"
            )
        return value

    return integer


def _charts(text: str) -> int:
    return 0 if text == "auto" else integer(1)(text)


def _above(least: float) -> Callable[[str], float]:
    def parse(text: str) -> float:
        value = number(text)
        if not value > least:
            raise argparse.ArgumentTypeError(f"expected a number above {least:g}, found '{text}'")
        return value

    return parse


_positive = _above(0)


def _weld(text: str) -> float:
    named = {"on": 0.0, "off": -1.0}
    share = number(text)
    if text not in named and not 0 < share <= 0.01:
        raise argparse.ArgumentTypeError(f"expected on, off or a share to 0.01, found '{text}'")
    return named.get(text, share)


def _size_mm(text: str) -> float:
    value = millimetres()(text)
    if value == 0:
        raise argparse.ArgumentTypeError(f"expected a length above 0, found '{text}'")
    return value


_stretch = _above(1)


def _formats(text: str) -> tuple[str, ...]:
    return _words(text, FORMATS)


def methods(text: str) -> tuple[str, ...]:
    """The type of an option: methods of segmentation, with commas between them."""
    return _words(text, tuple(METHODS))


def _words(text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    chosen = tuple(dict.fromkeys(text.lower().split(",")))
    for name in chosen:
        if name not in known:
            raise argparse.ArgumentTypeError(f"expected some of {','.join(known)}, found '{name}'")
    return chosen


def run_options(args: argparse.Namespace, parser: argparse.ArgumentParser) -> RunOptions:
    """What the options of add_run_options ask for; parser reports those that do not fit."""
    from devseg.pipeline import RunOptions

    given_seams = args.charts_from or args.keep_seams or args.material_borders
    if args.close_holes and (args.keep_texcoords or given_seams):
        parser.error("--close-holes needs charts that the method makes, without those of the file")
    if args.keep_texcoords and (args.target_faces or "ply" not in args.formats):
        parser.error("--keep-texcoords needs --formats with ply, and no --target-faces")
    method = METHODS[args.method]
    chosen = {name: getattr(args, name) for name in METHOD_OPTIONS}
    segmentation: dict[str, Any] = {}
    for name, value in chosen.items():
        if value is None:
            continue
        if name not in method.options:
            parser.error(f"--{name.replace('_', '-')} does not apply to --method {method.name}")
        segmentation[method.options[name]] = value
    if args.deform != "auto" and "deform" in method.parameters:
        segmentation["deform"] = DEFORM[args.deform]
    if args.max_l2_stretch or args.max_linf_stretch:
        if args.charts:
            parser.error("bounds on the stretch find the number of charts: give --charts auto")
        segmentation["charts_number"] = 0
    elif args.charts == 0 and "max_l2_stretch" not in method.options:
        parser.error(f"--charts auto does not apply to --method {method.name}")
    cloth.check(args, parser)
    pattern = pattern_parameters(args)
    if args.material and method.bounds_material:
        segmentation["material"] = args.material
    if method.preset:
        pattern.setdefault("preset", PRESETS[method.preset])
    bounds_strain = args.material and method.bounds_material
    flattening = args.flatten or ("lpfb" if bounds_strain else method.flatten)
    return RunOptions(
        args.out,
        method,
        segmentation,
        flattening,
        args.formats,
        pattern,
        args.target_faces,
        args.longest_mm,
        args.up,
        tuple(args.objects),
        args.picture,
        args.keep_texcoords,
        _smooth_seams(args, pattern, parser),
        args.weld,
        given.check(args, parser),
        None if args.deform == "auto" else args.deform == "always",
        args.close_holes,
        args.effort,
    )


def _smooth_seams(
    args: argparse.Namespace, pattern: dict[str, Any], parser: argparse.ArgumentParser
) -> bool:
    """Whether seams become smooth curves: asked for, or a pattern to sew or to cut."""
    if args.seams == "smooth" and args.method not in SMOOTH_METHODS:
        parser.error(f"--seams smooth does not apply to --method {args.method}")
    if args.seams == "smooth" and args.keep_texcoords:
        parser.error("--keep-texcoords needs the faces of the file: give --seams edges")
    given_seams = args.charts_from or args.keep_seams or args.material_borders
    if args.seams or given_seams:
        return args.seams == "smooth"  # seams that somebody has chosen stay where they are
    if args.material and METHODS[args.method].bounds_material:
        return False  # patches were judged with their seams on edges: curves strain them more
    is_pattern = any(kind in PATTERN_FORMATS for kind in args.formats)
    fits = args.method in SMOOTH_METHODS and not args.keep_texcoords
    return fits and is_pattern and pattern.get("preset") != PRESETS["papercraft"]
