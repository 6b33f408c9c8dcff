"""The command line `devseg`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from devseg import edit, given
from devseg.errors import DevsegError, one_line
from devseg.lengths import length, millimetres, number, shown, size
from devseg.methods import FLATTENINGS, METHOD_OPTIONS, METHODS, SMOOTH_METHODS
from devseg.pattern import (
    PATTERN_FORMATS,
    PRESETS,
    add_pattern_options,
    pattern_parameters,
)

FORMATS = (*PATTERN_FORMATS, "ply", "obj")


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command; returns 0, or 1 after one line on stderr (argparse leaves with 2)."""
    parser = _parser()
    args = parser.parse_args(argv)
    return guarded(lambda: args.command(args, args.subparser))


def guarded(command: Callable[[], None]) -> int:
    """Turns every failure into one line, and a traceback only where DEVSEG_DEBUG asks for it."""
    try:
        command()
    except (DevsegError, KeyboardInterrupt, Exception) as error:
        if os.environ.get("DEVSEG_DEBUG"):
            raise
        print(f"devseg: error: {_message(error)}", file=sys.stderr)
        return 1
    return 0


def _message(error: BaseException) -> str:
    if isinstance(error, DevsegError):
        return one_line(str(error))
    if isinstance(error, KeyboardInterrupt):
        return "interrupted; nothing of the unfinished input was written"
    if isinstance(error, OSError) and error.strerror:
        return one_line(f"{error.filename or 'file'}: {error.strerror}")
    text = one_line(f"{type(error).__name__}: {error}")
    return f"unexpected {text}; please report it with the output of DEVSEG_DEBUG=1"


def _parser() -> argparse.ArgumentParser:
    from devseg import __version__

    parser = argparse.ArgumentParser(
        prog="devseg",
        description="Cuts meshes into few, nearly developable charts and makes patterns of them.",
    )
    parser.add_argument("--version", action="version", version=f"devseg {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="segment, flatten, pack and export meshes")
    run.add_argument("input", nargs="+", type=Path, metavar="INPUT", help="a mesh file")
    run.add_argument("-o", "--out", type=Path, metavar="DIR", help="for the files")
    add_run_options(run)
    run.set_defaults(command=run_command, subparser=run)

    compare = commands.add_parser("compare", help="methods side by side: measures and a picture")
    compare.add_argument("input", type=Path, metavar="INPUT", help="a mesh file")
    compare.add_argument(
        "--methods",
        type=_methods,
        default=tuple(METHODS),
        metavar="LIST",
        help=f"of {','.join(METHODS)}; default: all",
    )
    compare.add_argument(
        "-o", "--out", type=Path, default=Path(), metavar="DIR", help="for the picture; default: ."
    )
    compare.add_argument(
        "--charts", type=_integer(1), metavar="N", help="for all methods; default: 20"
    )
    compare.add_argument("--seed", type=_integer(0), metavar="N", help="of the random choices")
    compare.add_argument(
        "--flatten", choices=FLATTENINGS, default="symmetric-dirichlet", help="of the charts"
    )
    compare.add_argument("--json", action="store_true", help="print the results as JSON")
    compare.set_defaults(command=_compare_command, subparser=compare)

    measure = commands.add_parser("measure", help="measures of a mesh with texture coordinates")
    measure.add_argument("input", type=Path, metavar="INPUT", help="a mesh file")
    measure.add_argument("--json", action="store_true", help="print them as JSON")
    measure.set_defaults(command=_measure_command, subparser=measure)

    change = commands.add_parser("edit", help="join, split and open charts by their numbers")
    edit.add_options(change)
    change.set_defaults(command=edit.command, subparser=change)

    info = commands.add_parser("info", help="versions, plugins, filters and hosts")
    info.set_defaults(command=_info_command, subparser=info)
    return parser


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
        type=_integer(4),
        metavar="N",
        help="simplify the mesh to N faces first; people fold tens of edges, not thousands",
    )
    parser.add_argument("--max-iterations", type=_integer(1), metavar="N", help="at most N rounds")
    parser.add_argument("--seed", type=_integer(0), metavar="N", help="of the random choices")
    parser.add_argument(
        "--flatten",
        choices=FLATTENINGS,
        help="default: symmetric-dirichlet; lpfb with --method plush",
    )
    parser.add_argument(
        "--seams",
        choices=("smooth", "edges"),
        help="smooth curves, which split faces, or edges of the mesh; default: smooth in patterns "
        f"to sew and to cut by {', '.join(SMOOTH_METHODS)}, else edges",
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
        type=_integer(1),
        metavar="N",
        help="take this connected component, the largest is 1; default: all",
    )
    parser.add_argument(
        "--list-objects", action="store_true", help="only print the objects of the file"
    )


def _integer(least: int) -> Callable[[str], int]:
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
    return 0 if text == "auto" else _integer(1)(text)


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


def _methods(text: str) -> tuple[str, ...]:
    return _words(text, tuple(METHODS))


def _words(text: str, known: tuple[str, ...]) -> tuple[str, ...]:
    chosen = tuple(dict.fromkeys(text.lower().split(",")))
    for name in chosen:
        if name not in known:
            raise argparse.ArgumentTypeError(f"expected some of {','.join(known)}, found '{name}'")
    return chosen


def run_command(args: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    """`devseg run`; parser reports wrong usage."""
    from devseg.outputs import to_json
    from devseg.pipeline import RunOptions, run

    if args.list_objects:
        _list_objects(args)
        return
    if args.out is None:
        parser.error("the following arguments are required: -o/--out")
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
    if args.max_l2_stretch or args.max_linf_stretch:
        if args.charts:
            parser.error("bounds on the stretch find the number of charts: give --charts auto")
        segmentation["charts_number"] = 0
    elif args.charts == 0 and "max_l2_stretch" not in method.options:
        parser.error(f"--charts auto does not apply to --method {method.name}")
    _check_names(args, parser)
    pattern = pattern_parameters(args)
    if method.preset:
        pattern.setdefault("preset", PRESETS[method.preset])
    flattening = args.flatten or method.flatten
    options = RunOptions(
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
    )
    results = []
    for path in args.input:
        result = run(path, options)
        for warning in result["warnings"]:
            print(f"devseg: warning: {path}: {warning}", file=sys.stderr)
        results.append(result)
        if not args.json:
            print(_summary(result, args.out))
    if args.json:
        sys.stdout.write(to_json(results[0] if len(results) == 1 else results))


def _list_objects(args: argparse.Namespace) -> None:
    from devseg.apart import READING, run_apart
    from devseg.load import list_objects
    from devseg.outputs import to_json

    def read(path: Path, tell: Callable[[str], None]) -> dict[str, int]:
        tell(READING)
        return list_objects(path)

    found = {str(p): run_apart(str(p), lambda tell, p=p: read(p, tell)) for p in args.input}
    if args.json:
        sys.stdout.write(to_json(found))
        return
    for path, objects in found.items():
        for name, faces in objects.items():
            head = f"{path}: " if len(found) > 1 else ""
            print(f"{head}{name or '(no name)'}\t{faces} faces")


def _smooth_seams(
    args: argparse.Namespace, pattern: dict[str, Any], parser: argparse.ArgumentParser
) -> bool:
    """Whether seams become smooth curves: asked for, or a pattern to sew or to cut."""
    if args.seams == "smooth" and args.method not in SMOOTH_METHODS:
        parser.error(f"--seams smooth does not apply to --method {args.method}")
    if args.seams == "smooth" and args.keep_texcoords:
        parser.error("--keep-texcoords needs the faces of the file: give --seams edges")
    if args.seams or args.charts_from or args.keep_seams:
        return args.seams == "smooth"  # seams that somebody has chosen stay where they are
    is_pattern = any(kind in PATTERN_FORMATS for kind in args.formats)
    fits = args.method in SMOOTH_METHODS and not args.keep_texcoords
    return fits and is_pattern and pattern.get("preset") != PRESETS["papercraft"]


def _check_names(args: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    """No input may overwrite another's outputs, nor be overwritten by them."""
    seen: dict[str, Path] = {}
    for path in args.input:
        if path.stem in seen:
            parser.error(
                f"{seen[path.stem]} and {path} would write the same files; use one -o DIR for each"
            )
        seen[path.stem] = path
        for extension in args.formats:
            target = args.out / f"{path.stem}.{extension}"
            if target.exists() and path.exists() and target.samefile(path):
                parser.error(f"{path} would be overwritten; choose another -o DIR")


_LABELS = {
    "svg": "pattern",
    "pdf": "pattern",
    "dxf": "pattern",
    "ply": "mesh",
    "obj": "mesh",
    "png": "picture",
    "json": "measures",
}


def _summary(result: dict[str, Any], out: Path) -> str:
    lines = [f"{_LABELS[kind]:<9} {out / name}" for kind, name in result["outputs"].items()]
    lines.append(f"{'size':<9} {shown(result['size_mm'])}")
    flat = result["parametrization"]
    figures = [
        f"{flat['charts_number']} charts",
        f"L2 stretch {flat['l2_stretch']:.4g}",
        f"Linf stretch {flat['linf_stretch']:.4g}",
        f"seams {flat['seam_length']:.4g} units",
        f"packing {100 * flat['packing_efficiency']:.0f} %",
        f"{sum(result['seconds'].values()):.1f} s",
    ]
    lines.append(f"{'figures':<9} {', '.join(figures)}")
    if "simplification" in result:
        simple = result["simplification"]
        mean, largest = 100 * simple["mean_deviation"], 100 * simple["largest_deviation"]
        lines.append(
            f"{'simpler':<9} {simple['faces']} faces, {mean:.2g} % of the diagonal away "
            f"on average, {largest:.2g} % at most"
        )
    if "deformation" in result:
        moved = result["deformation"]
        lines.append(
            f"{'deformed':<9} by {100 * moved['mean_share']:.2g} % of the diagonal on average, "
            f"{100 * moved['largest_share']:.2g} % at most, "
            f"{moved['residual']:.1g} rad from developable"
        )
    return "\n".join(lines)


def _compare_command(args: argparse.Namespace, _: argparse.ArgumentParser) -> None:
    from devseg.compare import CompareOptions, compare, table
    from devseg.outputs import to_json

    methods = [METHODS[name] for name in args.methods]
    given = {"charts": args.charts, "seed": args.seed}
    segmentation = [
        {
            method.options[name]: value
            for name, value in given.items()
            if value is not None and name in method.options
        }
        for method in methods
    ]
    result = compare(args.input, CompareOptions(args.out, methods, segmentation, args.flatten))
    for warning in result["warnings"]:
        print(f"devseg: warning: {args.input}: {warning}", file=sys.stderr)
    if args.json:
        sys.stdout.write(to_json(result))
        return
    print(table(result))
    print(f"{'picture':<34}{args.out / result['outputs']['png']}")


def _measure_command(args: argparse.Namespace, _: argparse.ArgumentParser) -> None:
    from devseg.measure import measure
    from devseg.outputs import to_json

    result = measure(args.input)
    if args.json:
        sys.stdout.write(to_json(result))
        return
    for group in ("segmentation", "parametrization"):
        print(group)
        for name, value in result[group].items():
            if not hasattr(value, "__len__"):
                print(f"  {name:<28} {value:.6g}")
    flat = result["parametrization"]
    _print_table("chart", flat, first=1)
    _print_table("seam", flat)


def _print_table(prefix: str, measures: dict[str, Any], first: int | None = None) -> None:
    """One row for each chart or seam; `first` numbers the rows from there."""
    columns = {
        name.removeprefix(f"{prefix}_"): value
        for name, value in measures.items()
        if name.startswith(f"{prefix}_") and hasattr(value, "__len__")
    }
    print(f"{prefix}s")
    print("  " + " ".join(f"{name:>16}" for name in ([prefix] if first else []) + [*columns]))
    for row, values in enumerate(zip(*columns.values(), strict=True)):
        numbers = ([first + row] if first else []) + list(values)
        print("  " + " ".join(f"{number:>16.6g}" for number in numbers))


def _info_command(_: argparse.Namespace, __: argparse.ArgumentParser) -> None:
    from devseg.info import info

    print(info())
