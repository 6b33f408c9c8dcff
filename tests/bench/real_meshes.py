"""Runs devseg over a folder of meshes, as `devseg batch` does, and tells how each of them ended.

    .venv/bin/python tests/bench/real_meshes.py DIR [-o OUT] [--plugins DIR] [--jobs N]
        [--half even|odd] [--every K] [--seconds S] [--memory-gb G] [--keep] [-- OPTION...]

Options after -- go to `devseg run`. OUT gets the report of the batch, and a copy of the plugins, by
which a run that was stopped goes on. The last line of the output sums up. Fails where a mesh killed
its process or went over a limit.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from devseg import plugin_paths
from devseg.apart import Limits
from devseg.batch import BatchOptions, Step, find_inputs, run_batch
from devseg.batch_task import CRASHED, OVER_MEMORY, OVER_TIME, PATTERN, REFUSED
from devseg.cli import add_run_options, run_options

LARGE_L2 = 1.02


def summary(records: Sequence[dict[str, Any]]) -> str:
    """One line about all meshes."""

    def count(ending: str) -> int:
        return sum(r["ending"] == ending for r in records)

    done = [r for r in records if r["ending"] == PATTERN]
    charts = [r["charts"] for r in done] or [0]
    high = sum(r["l2"] is None or r["l2"] > LARGE_L2 for r in done)
    worst = sum((r["worst_chart_l2"] or 9) > LARGE_L2 for r in done)
    wrong = sum(r["flipped"] > 0 or r["overlapping"] > 0 for r in done)
    cpu = [r["cpu_seconds"] for r in records if "cpu_seconds" in r] or [0]
    return (
        f"{len(records)} meshes, {len(done)} patterns, {count(REFUSED)} refused, "
        f"{count(CRASHED)} killed, {count(OVER_TIME)} over time, "
        f"{count(OVER_MEMORY)} over memory, L2 above {LARGE_L2} on {high}, "
        f"a chart above it on {worst}, flips or overlaps on {wrong}, "
        f"median charts {statistics.median(charts):g}, sum of charts {sum(charts)}, "
        f"median CPU {statistics.median(cpu):.1f} s, sum {sum(cpu):.0f} s, "
        f"most memory {max((r.get('memory_mb', 0) for r in records), default=0)} MB"
    )


def chosen_meshes(args: argparse.Namespace) -> dict[str, Path]:
    """Those of the folder by name, sorted; a half or every K-th of them."""
    found = find_inputs([args.folder])
    names = list(found)
    if args.half:
        names = names[{"even": 0, "odd": 1}[args.half] :: 2]
    return {name: found[name] for name in names[:: args.every]}


def keep_plugins(out: Path, chosen: Path | None) -> Path:
    """A copy of the plugins in OUT, as a build that goes on must not change what is measured.

    A run that goes on takes the copy, and refuses others.
    """
    copies = out / "plugins"
    if chosen:
        os.environ["DEVSEG_PLUGIN_DIR"] = str(chosen.resolve())
    elif copies.is_dir():
        return copies
    copies.mkdir(parents=True, exist_ok=True)
    for path in plugin_paths():
        copy = copies / path.name
        if copy.exists() and copy.read_bytes() != path.read_bytes():
            raise SystemExit(f"{out} holds a run with other plugins; choose another -o OUT")
        shutil.copy2(path, copy)
    return copies


def parse(argv: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="looked through with its folders")
    parser.add_argument("-o", "--out", type=Path, default=Path("real_meshes"), metavar="OUT")
    parser.add_argument("--plugins", type=Path, metavar="DIR", help="default: as devseg finds them")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="default: 2")
    parser.add_argument("--half", choices=("even", "odd"), help="every other mesh")
    parser.add_argument("--every", type=int, default=1, metavar="K", help="the first of each K")
    parser.add_argument("--seconds", type=float, default=60.0, metavar="S", help="default: 60")
    parser.add_argument("--memory-gb", type=float, default=4.0, metavar="G", help="default: 4")
    parser.add_argument("--keep", action="store_true", help="all files, in OUT/meshes")
    words = list(sys.argv[1:] if argv is None else argv)
    end = words.index("--") if "--" in words else len(words)
    return parser.parse_args(words[:end], argparse.Namespace(options=words[end + 1 :]))


def batch_options(args: argparse.Namespace) -> BatchOptions:
    parser = argparse.ArgumentParser(prog="devseg run")
    add_run_options(parser)
    run = parser.parse_args(args.options, argparse.Namespace(out=args.out))
    limits = Limits(args.seconds, int(args.memory_gb * 2**30))
    return BatchOptions(run_options(run, parser), limits, args.jobs, keep=args.keep)


def tell(step: Step) -> None:
    record = step.record
    about = record["reason"] or f"{record['charts']} charts, L2 {record['l2'] or 9:.4f}"
    print(
        f"{step.done}/{step.all} {record['mesh']}: {record['ending']}, "
        f"{record.get('cpu_seconds', 0):.1f} s, {about}",
        flush=True,
    )


def main(argv: Sequence[str] | None = None) -> int:
    args = parse(argv)
    if not args.folder.is_dir():
        raise SystemExit(f"{args.folder}: expected a folder of meshes")
    # Workers are children, and load the same ones.
    os.environ["DEVSEG_PLUGIN_DIR"] = str(keep_plugins(args.out, args.plugins).resolve())
    found = run_batch(chosen_meshes(args), batch_options(args), tell)
    records = [record for record in found if record is not None]
    print(summary(records))
    return int(any(r["ending"] not in (PATTERN, REFUSED) for r in records))


if __name__ == "__main__":
    sys.exit(main())
