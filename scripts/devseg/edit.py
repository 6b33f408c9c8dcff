"""`devseg edit`: charts joined and split, seams removed, by the numbers on the pattern."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from devseg import ply
from devseg.apart import READING, Tell, run_apart
from devseg.errors import DevsegError
from devseg.given import CHARTS_ATTRIBUTE, EDGES_ATTRIBUTE
from devseg.lengths import number
from devseg.load import load_mesh
from devseg.methods import FLATTENINGS
from devseg.outputs import plain, staged, to_json
from devseg.pipeline import FLATTEN_FILTER, PARAMETRIZATION_MEASURES, Session
from devseg.plugins import load_plugins
from devseg.progress import Progress

# Options, the filters that they apply, and the parameter that takes their numbers.
STEPS = {
    "join": ("apply_charts_join_selected", "pieces", "join these pieces, such as 3,5"),
    "split": ("apply_charts_split_selected", "pieces", "split each of these the best way in two"),
    "remove-seam": ("apply_charts_remove_selected_seams", "seams", "take these seams away"),
    "dart": ("apply_charts_add_dart", "vertices", "cut darts up to these vertices, from 0"),
}


@dataclass(frozen=True)
class EditOptions:
    """What `devseg edit` is to do.

    Attributes:
        out: the PLY file to write.
        steps: options and their numbers, in order.
        force: whether changes count that charts do not bear.
        bound: of the L2 stretch of charts that are joined; None: the filter's own.
        flatten: key of FLATTENINGS.
    """

    out: Path
    steps: Sequence[tuple[str, str]]
    force: bool
    bound: float | None
    flatten: str


class _Step(argparse.Action):
    """Keeps the steps in the order in which they were given."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        steps = [*(getattr(namespace, "steps", None) or []), (str(option_string)[2:], values)]
        namespace.steps = steps


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options of `devseg edit`."""
    parser.add_argument("input", type=Path, metavar="INPUT", help="a PLY file of 'devseg run'")
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="OUT.ply", help="the changed mesh"
    )
    steps = parser.add_argument_group(
        "steps, in this order; numbers are those on the pattern of INPUT"
    )
    for name, (_, _, text) in STEPS.items():
        steps.add_argument(f"--{name}", action=_Step, metavar="N,N", default=None, help=text)
    parser.add_argument(
        "--force", action="store_true", help="even where charts then stretch above the bound"
    )
    parser.add_argument(
        "--max-l2-stretch",
        type=_stretch,
        metavar="S",
        help="of a chart that is joined; default: 1.02",
    )
    parser.add_argument(
        "--flatten", choices=FLATTENINGS, default="symmetric-dirichlet", help="of the charts"
    )
    parser.add_argument("--json", action="store_true", help="print the results as JSON")


def _stretch(text: str) -> float:
    value = number(text)
    if not value > 1:
        raise argparse.ArgumentTypeError(f"expected a number above 1, found '{text}'")
    return value


def command(args: argparse.Namespace, parser: argparse.ArgumentParser) -> None:
    """`devseg edit`; parser reports wrong usage."""
    result = edit(args.input, options_of(args, parser))
    for warning in result["warnings"]:
        print(f"devseg: warning: {args.input}: {warning}", file=sys.stderr)
    if args.json:
        sys.stdout.write(to_json(result))
        return
    for step in result["steps"]:
        print(
            f"{step['step']:<11} {step['numbers']:<9} {step['charts_number']} charts, "
            f"L2 stretch {step['l2_stretch']:.4g} of what has changed"
        )
    print(f"{'mesh':<11} {args.out}")


def options_of(args: argparse.Namespace, parser: argparse.ArgumentParser) -> EditOptions:
    """The options as they were given; parser reports wrong usage."""
    steps = getattr(args, "steps", None) or []
    if not steps:
        parser.error("expected a step such as --join 3,5, found none")
    if args.out.suffix.lower() != ".ply":
        parser.error(f"expected a PLY file to write, found '{args.out}'")
    if args.out.exists() and args.input.exists() and args.out.samefile(args.input):
        parser.error(f"{args.input} would be overwritten; choose another -o OUT.ply")
    return EditOptions(args.out, steps, args.force, args.max_l2_stretch, args.flatten)


def edit(path: Path, options: EditOptions) -> dict[str, Any]:
    """Applies the steps to the charts of a file and writes the flattened result.

    Raises:
        DevsegError: with nothing written.
    """
    with staged(options.out.parent) as folder:
        return run_apart(str(path), lambda tell: plain(_edit(path, options, folder, tell)))


def _edit(path: Path, options: EditOptions, folder: Path, tell: Tell) -> dict[str, Any]:
    progress = Progress(path.stem, tell=tell)
    with progress.stage("start"):
        load_plugins()
    with progress.stage(READING):
        loaded = load_mesh(path)
    mesh = loaded.meshes.current_mesh()
    session = Session(path, loaded.meshes, loaded.warnings)
    ply.restore_attributes(mesh, path)
    if not mesh.has_wedge_tex_coord():
        raise DevsegError(
            f"{path}: expected texture coordinates, whose pattern has the numbers, found none; "
            "make the file with 'devseg run'"
        )
    # The coordinates stay until the last step: so numbers mean the same in all steps.
    done = []
    for name, numbers in options.steps:
        with progress.stage(name):
            done.append(
                {"step": name, "numbers": numbers, **_apply(session, options, name, numbers)}
            )
    with progress.stage("flatten"):
        session.apply(FLATTEN_FILTER, method=FLATTENINGS[options.flatten])
    with progress.stage("measure"):
        measures = session.apply(PARAMETRIZATION_MEASURES)
    target = folder / options.out.name
    with progress.stage("ply"):
        attributes = {f"__ca_fs__{name}": True for name in (CHARTS_ATTRIBUTE, EDGES_ATTRIBUTE)}
        session.save(target, binary=True, save_textures=False, **attributes)
        ply.finish(target, [])
    return {
        "input": path.name,
        "steps": done,
        "parametrization": measures,
        "warnings": session.warnings,
        "seconds": progress.seconds,
        "outputs": {"ply": target.name},
    }


def _apply(session: Session, options: EditOptions, name: str, numbers: str) -> dict[str, Any]:
    filter_, parameter, _ = STEPS[name]
    parameters: dict[str, Any] = {parameter: numbers, "force": options.force}
    if options.bound is not None and name in ("join", "remove-seam"):
        parameters["max_chart_l2_stretch"] = options.bound
    try:
        return session.apply(filter_, **parameters)
    except DevsegError as error:
        raise DevsegError(
            str(error)
            .replace(f"{parameter}: ", f"--{name}: ")
            .replace("force: ", f"--{name} {numbers}: ")
            .replace(
                "raise max_chart_l2_stretch, or switch force on",
                "give --force or a larger --max-l2-stretch",
            )
            .replace("switch force on", "give --force")
        ) from error
