"""`devseg batch` on the command line."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from devseg.errors import DevsegError
from devseg.lengths import number

if TYPE_CHECKING:
    from collections.abc import Callable

    from devseg.batch import BatchOptions, Step

# Of a mesh, where nobody says more.
TIMEOUT_SECONDS = 600.0


def add_batch_options(parser: argparse.ArgumentParser) -> None:
    """The options of `devseg batch` beside those of `devseg run`."""
    parser.add_argument(
        "input", nargs="+", type=Path, metavar="INPUT", help="a mesh file, or a folder of them"
    )
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="DIR", help="for all")
    group = parser.add_argument_group("many meshes")
    group.add_argument(
        "--jobs", type=_count, metavar="N", help="meshes at a time; default: one for each core"
    )
    group.add_argument(
        "--timeout",
        type=_positive,
        default=TIMEOUT_SECONDS,
        metavar="S",
        help=f"seconds of processor time for each mesh; default: {TIMEOUT_SECONDS:g}",
    )
    group.add_argument(
        "--memory", type=_positive, metavar="GB", help="for each mesh; default: no limit"
    )
    group.add_argument(
        "--rank", type=_index, metavar="R", help="do the share R of W, from 0 (--world-size W); "
        "default: as a job array of SLURM says"
    )  # fmt: skip
    group.add_argument("--world-size", type=_count, metavar="W", help="shares of all meshes")
    group.add_argument(
        "--executor",
        type=_executor,
        default="local",
        metavar="local|dask[:ADDRESS]",
        help="where it runs: in processes here, on a Dask cluster that is started here, or on the "
        "one of a scheduler such as dask:tcp://host:8786",
    )


def batch_command(
    args: argparse.Namespace,
    parser: argparse.ArgumentParser,
    run_options: Callable[[argparse.Namespace, argparse.ArgumentParser], Any],
) -> None:
    """`devseg batch`; parser reports wrong usage.

    Raises:
        DevsegError: where a mesh of this process's share has no pattern.
    """
    from devseg.batch import find_inputs, run_batch
    from devseg.batch_report import summary
    from devseg.batch_task import PATTERN
    from devseg.outputs import to_json

    if args.list_objects:
        parser.error("--list-objects does not apply: it is for devseg run")
    options = _options(args, parser, run_options)
    inputs = find_inputs(args.input)
    show = _Progress()
    try:
        records = run_batch(inputs, options, show)
    finally:
        show.end()
    done = [record for record in records if record is not None]
    if args.json:
        sys.stdout.write(to_json(done))
    else:
        missing = f", {len(records) - len(done)} of other ranks" if len(done) < len(records) else ""
        print(f"{summary(done)}{missing}")
        print(f"report    {args.out / 'index.html'}")
        print(f"table     {args.out / 'report.csv'}")
    failed = sum(record["ending"] != PATTERN for record in done)
    if failed:
        raise DevsegError(
            f"expected a pattern of every mesh, found {failed} of {len(done)} without one; "
            f"{args.out / 'index.html'} has the reasons"
        )


def _options(
    args: argparse.Namespace,
    parser: argparse.ArgumentParser,
    run_options: Callable[[argparse.Namespace, argparse.ArgumentParser], Any],
) -> BatchOptions:
    from devseg.apart import Limits
    from devseg.batch import BatchOptions, slurm_rank

    if (args.rank is None) != (args.world_size is None):
        parser.error("--rank and --world-size go together")
    rank, world_size = 0, 1
    if args.rank is not None:
        rank, world_size = args.rank, args.world_size
    else:
        rank, world_size = slurm_rank(os.environ) or (0, 1)
    if not 0 <= rank < world_size:
        parser.error(f"--rank: expected a number from 0 to {world_size - 1}, found {rank}")
    memory = None if args.memory is None else int(args.memory * 2**30)
    return BatchOptions(
        run_options(args, parser),
        Limits(args.timeout, memory),
        args.jobs or len(os.sched_getaffinity(0)),
        rank,
        world_size,
        args.executor,
    )


class _Progress:
    """A line for each mesh; on a terminal one line that is written again and again."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._failed = 0
        self._began = False

    def __call__(self, step: Step) -> None:
        from devseg.batch_task import PATTERN
        from devseg.progress import CLEAR_LINE

        record = step.record
        good = record["ending"] == PATTERN
        self._failed += not good
        charts = record.get("charts")
        about = f"{charts} chart{'s' * (charts != 1)}" if good else record["reason"]
        line = f"{record['mesh']}: {record['ending']}, {about}"
        work = f"{step.done}/{step.all}, {step.rate:.2g} a second, {_span(step.seconds_left)} left"
        if not self._terminal:
            print(f"{work}: {line}", file=sys.stderr, flush=True)
            return
        # Failures stay on the screen, the rest is overwritten.
        text = CLEAR_LINE + ("" if good else f"{line}\n")
        failed = f", {self._failed} without a pattern" if self._failed else ""
        sys.stderr.write(f"{text}{work}{failed}")
        sys.stderr.flush()
        self._began = True

    def end(self) -> None:
        if self._began:
            sys.stderr.write("\n")


def _span(seconds: float) -> str:
    """Time as people say it."""
    minutes = round(seconds / 60)
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{minutes} min" if minutes < 90 else f"{minutes / 60:.1f} h"


def _count(text: str) -> int:
    return _whole(text, 1)


def _index(text: str) -> int:
    return _whole(text, 0)


def _whole(text: str, least: int) -> int:
    if not text.isdecimal() or int(text) < least:
        raise argparse.ArgumentTypeError(
            f"expected a whole number of at least {least}, found '{text}'"
        )
    return int(text)


def _positive(text: str) -> float:
    value = number(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f"expected a number above 0, found '{text}'")
    return value


def _executor(text: str) -> str:
    kind, colon, address = text.partition(":")
    if kind not in ("local", "dask") or (colon and (kind == "local" or not address)):
        raise argparse.ArgumentTypeError(f"expected local, dask or dask:ADDRESS, found '{text}'")
    return text
