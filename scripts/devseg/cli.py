"""The command line `devseg`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from devseg import edit
from devseg.batch_cli import add_batch_options, batch_command
from devseg.completion import SHELLS, completion
from devseg.errors import DevsegError, one_line
from devseg.help_text import add_examples
from devseg.lengths import shown
from devseg.methods import FLATTENINGS, METHODS
from devseg.run_options import add_run_options, integer, methods, run_options


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

    batch = commands.add_parser("batch", help="devseg run for thousands of meshes, with a report")
    add_batch_options(batch)
    add_run_options(batch)
    batch.set_defaults(
        command=lambda args, parser: batch_command(args, parser, run_options), subparser=batch
    )

    compare = commands.add_parser("compare", help="methods side by side: measures and a picture")
    compare.add_argument("input", type=Path, metavar="INPUT", help="a mesh file")
    compare.add_argument(
        "--methods",
        type=methods,
        default=tuple(METHODS),
        metavar="LIST",
        help=f"of {','.join(METHODS)}; default: all",
    )
    compare.add_argument(
        "-o", "--out", type=Path, default=Path(), metavar="DIR", help="for the picture; default: ."
    )
    compare.add_argument(
        "--charts", type=integer(1), metavar="N", help="for all methods; default: 20"
    )
    compare.add_argument("--seed", type=integer(0), metavar="N", help="of the random choices")
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
    info.add_argument("--json", action="store_true", help="print them as JSON")
    info.set_defaults(command=_info_command, subparser=info)

    shell = commands.add_parser("completion", help="a script that completes words in a shell")
    shell.add_argument("shell", choices=SHELLS, help="of which shell")
    shell.set_defaults(command=_completion_command, subparser=shell)
    add_examples(commands)
    return parser


def run_command(args: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    """`devseg run`; parser reports wrong usage."""
    from devseg.outputs import to_json
    from devseg.pipeline import run

    if args.list_objects:
        _list_objects(args)
        return
    if args.out is None:
        parser.error("the following arguments are required: -o/--out")
    options = run_options(args, parser)
    _check_names(args, parser)
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

    found = {str(path): run_apart(str(path), partial(read, path)) for path in args.input}
    if args.json:
        sys.stdout.write(to_json(found))
        return
    for path, objects in found.items():
        for name, faces in objects.items():
            head = f"{path}: " if len(found) > 1 else ""
            print(f"{head}{name or '(no name)'}\t{faces} faces")


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
    "page": "pattern",
    "html": "guide",
    "marker": "marker",
    "ply": "mesh",
    "obj": "mesh",
    "png": "picture",
    "json": "measures",
}


def _summary(result: dict[str, Any], out: Path) -> str:
    # Of svg_200, the pattern in one of several sizes, and marker_svg the first word counts.
    lines = [
        f"{_LABELS[kind.split('_')[0]]:<9} {out / name}" for kind, name in result["outputs"].items()
    ]
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


def _info_command(args: argparse.Namespace, _: argparse.ArgumentParser) -> None:
    from devseg.info import info, info_text
    from devseg.outputs import to_json

    found = info()
    sys.stdout.write(to_json(found) if args.json else f"{info_text(found)}\n")


def _completion_command(args: argparse.Namespace, _: argparse.ArgumentParser) -> None:
    print(completion(_parser(), args.shell))
