"""Runs the command line over a folder of meshes and tells how each of them ended.

    .venv/bin/python tests/bench/real_meshes.py DIR [-o OUT] [--plugins DIR] [--jobs N]
        [--half even|odd] [--every K] [--seconds S] [--memory-gb G] [--keep] [-- OPTION...]

Each mesh has a process of its own, with a limit of time and memory; options after -- go to
`devseg run`. OUT gets results.csv, index.html with pictures and reasons, and results.jsonl, from
which a run that was stopped goes on. The last line of the output sums up. Fails where a mesh killed
the command line or went over a limit. Figures of L2 and so on are those of NAME.json.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from real_meshes_page import page

from devseg import plugin_paths

FORMATS = (".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".3ds", ".dae", ".3mf")
# On a busy machine a process waits: the limit of time is passed when it has also worked so long, or
# when it has waited for so many times as long.
BUSY = 5
PATTERN, REFUSED, KILLED = "pattern", "refused", "killed"
OVER_TIME, OVER_MEMORY = "over time", "over memory"
ENDINGS = (PATTERN, REFUSED, KILLED, OVER_TIME, OVER_MEMORY)
LARGE_L2 = 1.02
COLUMNS = (
    "mesh",
    "ending",
    "faces",
    "charts",
    "disks",
    "l2",
    "linf",
    "worst_chart_l2",
    "seam_length",
    "flipped",
    "overlapping",
    "packing",
    "seconds",
    "cpu_seconds",
    "memory_mb",
    "warnings",
    "reason",
)


@dataclass(frozen=True)
class Limits:
    """Of one mesh: seconds, and bytes of its largest process."""

    seconds: float
    memory: int


@dataclass(frozen=True)
class Ended:
    """How a command ended: its exit status, or the limit that it went over."""

    status: int
    over: str
    output: str
    errors: str
    seconds: float
    cpu_seconds: float
    memory: int


def run_limited(command: Sequence[str], limits: Limits, environment: dict[str, str]) -> Ended:
    """Runs a command and ends it, with all its children, where it goes over a limit."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        start = time.monotonic()
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            env=environment,
            start_new_session=True,
        )
        over, memory, working = "", 0, 0.0
        # Its children are counted in what the system reports when all have ended.
        while not (ended := os.wait4(process.pid, os.WNOHANG))[0]:
            time.sleep(0.05)
            working, largest = _usage(process.pid)
            memory = max(memory, largest)
            waited = time.monotonic() - start
            if memory > limits.memory:
                over = OVER_MEMORY
            elif min(working, waited) > limits.seconds or waited > BUSY * limits.seconds:
                over = OVER_TIME
            if over:
                os.killpg(process.pid, signal.SIGKILL)
                ended = os.wait4(process.pid, 0)
                break
        _, status, usage = ended
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for file in (output, errors):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
        return Ended(
            process.returncode,
            over,
            *texts,
            time.monotonic() - start,
            # Of children that were ended with it the system knows nothing.
            max(working, usage.ru_utime + usage.ru_stime),
            max(memory, usage.ru_maxrss * 1024),
        )


def _usage(pid: int) -> tuple[float, int]:
    """Processor seconds of a process and its children, and the most memory that one has used."""
    seconds, memory, todo = 0.0, 0, [pid]
    while todo:
        one = todo.pop()
        try:
            folder = Path(f"/proc/{one}")
            fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
            peak = re.search(r"^VmHWM:\s*(\d+)", (folder / "status").read_text(), re.MULTILINE)
            todo += map(int, (folder / "task" / str(one) / "children").read_text().split())
        except OSError:  # it has just ended
            continue
        seconds += (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        memory = max(memory, 1024 * int(peak[1]) if peak else 0)
    return seconds, memory


def run_mesh(name: str, args: argparse.Namespace, environment: dict[str, str]) -> dict[str, Any]:
    """One mesh: how it ended, its figures, and its picture in OUT/pictures."""
    path = args.folder / name
    work = args.out / "files" / name
    shutil.rmtree(work, ignore_errors=True)
    command = [sys.executable, "-m", "devseg", "run", str(path), "-o", str(work), "--json"]
    limits = Limits(args.seconds, int(args.memory_gb * 2**30))
    ended = run_limited([*command, *args.options], limits, environment)
    record = {
        "mesh": name,
        "seconds": round(ended.seconds, 2),
        "cpu_seconds": round(ended.cpu_seconds, 2),
        "memory_mb": round(ended.memory / 2**20),
        **outcome(ended, sorted(work.iterdir()) if work.is_dir() else []),
    }
    pictures = list(work.glob("*.png")) if record["ending"] == PATTERN else []
    if pictures:
        _thumbnail(pictures[0], args.out / "pictures" / f"{name}.png")
    if not args.keep:
        shutil.rmtree(work, ignore_errors=True)
    return record


def outcome(ended: Ended, files: list[Path]) -> dict[str, Any]:
    """The ending, its reason and the figures."""
    lines = ended.errors.splitlines()
    errors = [line.split("devseg: error: ", 1)[1] for line in lines if "devseg: error: " in line]
    warnings = [line for line in lines if "devseg: warning: " in line]
    reason = errors[-1] if errors else (lines[-1] if lines else "no word")
    if ended.over:
        return {"ending": ended.over, "reason": f"ended after {ended.seconds:.0f} s"}
    if ended.status == 0 and files:
        return {
            "ending": PATTERN,
            "reason": "",
            "warnings": [line.split("devseg: warning: ", 1)[1] for line in warnings],
            **figures(json.loads(ended.output)),
        }
    # A refusal is one line and leaves nothing; anything else is a crash, whoever noticed it.
    crash = re.search(r"crashed with|ended by the system|unexpected |ended with status", reason)
    if ended.status == 1 and len(errors) == 1 and not files and not crash:
        return {"ending": REFUSED, "reason": reason}
    left = f"; left {[file.name for file in files]}" if files else ""
    return {"ending": KILLED, "reason": f"status {ended.status}: {reason}{left}"}


def figures(result: dict[str, Any]) -> dict[str, Any]:
    """What the table shows of NAME.json."""
    flat = result["parametrization"]
    return {
        "faces": result["mesh"]["faces"],
        "charts": flat["charts_number"],
        "disks": flat["disk_charts_number"],
        "l2": flat["l2_stretch"],
        "linf": flat["linf_stretch"],
        "worst_chart_l2": max(flat["chart_l2_stretch"], default=None),
        "seam_length": flat["seam_length"],
        "flipped": flat["flipped_faces_number"],
        "overlapping": flat["overlapping_faces_number"],
        "packing": flat["packing_efficiency"],
        "stages": result["seconds"],
    }


def _thumbnail(picture: Path, target: Path) -> None:
    from PIL import Image

    target.parent.mkdir(parents=True, exist_ok=True)
    with Image.open(picture) as image:
        image.reduce(4).convert("P", palette=Image.Palette.ADAPTIVE, colors=64).save(target)


def summary(records: Sequence[dict[str, Any]]) -> str:
    """One line about all meshes."""
    count = {ending: sum(r["ending"] == ending for r in records) for ending in ENDINGS}
    done = [r for r in records if r["ending"] == PATTERN]
    charts = [r["charts"] for r in done] or [0]
    high = sum(r["l2"] is None or r["l2"] > LARGE_L2 for r in done)
    worst = sum((r["worst_chart_l2"] or 9) > LARGE_L2 for r in done)
    wrong = sum(r["flipped"] > 0 or r["overlapping"] > 0 for r in done)
    cpu = [r["cpu_seconds"] for r in records] or [0]
    return (
        f"{len(records)} meshes, {count[PATTERN]} patterns, {count[REFUSED]} refused, "
        f"{count[KILLED]} killed, {count[OVER_TIME]} over time, "
        f"{count[OVER_MEMORY]} over memory, L2 above {LARGE_L2} on {high}, "
        f"a chart above it on {worst}, flips or overlaps on {wrong}, "
        f"median charts {statistics.median(charts):g}, sum of charts {sum(charts)}, "
        f"median CPU {statistics.median(cpu):.1f} s, sum {sum(cpu):.0f} s, "
        f"most memory {max((r['memory_mb'] for r in records), default=0)} MB"
    )


def chosen_meshes(args: argparse.Namespace) -> list[str]:
    """Their paths in the folder, sorted; a half or every K-th of them."""
    names = sorted(
        str(path.relative_to(args.folder))
        for path in args.folder.rglob("*")
        if path.suffix.lower() in FORMATS and path.is_file()
    )
    if args.half:
        names = names[{"even": 0, "odd": 1}[args.half] :: 2]
    return names[:: args.every]


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


def load_records(out: Path, options: list[str]) -> dict[str, dict[str, Any]]:
    """What an earlier run into the same folder has found; refuses one with other options."""
    marker, log = out / "options.json", out / "results.jsonl"
    if marker.exists() and json.loads(marker.read_text()) != options:
        raise SystemExit(f"{out} holds a run with other options; choose another -o OUT")
    marker.write_text(json.dumps(options))
    if not log.exists():
        return {}
    # A run that was stopped may have left half a line.
    lines = log.read_text(encoding="utf-8").splitlines(keepends=True)
    whole = [line for line in lines if line.endswith("}\n")]
    log.write_text("".join(whole), encoding="utf-8")
    return {record["mesh"]: record for record in map(json.loads, whole)}


def write_tables(out: Path, records: Sequence[dict[str, Any]]) -> None:
    """results.csv and index.html, the failures first."""
    with (out / "results.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="", extrasaction="ignore")
        writer.writeheader()
        for record in records:
            warnings = "; ".join(record.get("warnings", []))
            writer.writerow({**record, "warnings": warnings})
    (out / "index.html").write_text(page(records, summary(records), ENDINGS), encoding="utf-8")


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
    parser.add_argument("--keep", action="store_true", help="all files, in OUT/files")
    words = list(sys.argv[1:] if argv is None else argv)
    end = words.index("--") if "--" in words else len(words)
    return parser.parse_args(words[:end], argparse.Namespace(options=words[end + 1 :]))


def main(argv: Sequence[str] | None = None) -> int:
    args = parse(argv)
    if not args.folder.is_dir():
        raise SystemExit(f"{args.folder}: expected a folder of meshes")
    plugins = keep_plugins(args.out, args.plugins)
    environment = {**os.environ, "DEVSEG_PLUGIN_DIR": str(plugins.resolve())}
    found = load_records(args.out, args.options)
    names = chosen_meshes(args)
    left = [name for name in names if name not in found]
    with (
        ThreadPoolExecutor(args.jobs) as pool,
        (args.out / "results.jsonl").open("a", encoding="utf-8") as log,
    ):
        running = [pool.submit(run_mesh, name, args, environment) for name in left]
        for number, future in enumerate(as_completed(running), start=1):
            record = future.result()
            found[record["mesh"]] = record
            log.write(json.dumps(record) + "\n")
            log.flush()
            about = record["reason"] or f"{record['charts']} charts, L2 {record['l2']:.4f}"
            print(
                f"{number}/{len(left)} {record['mesh']}: {record['ending']}, "
                f"{record['cpu_seconds']:.1f} s, {about}",
                flush=True,
            )
    records = [found[name] for name in names]
    write_tables(args.out, records)
    print(summary(records))
    return int(any(r["ending"] not in (PATTERN, REFUSED) for r in records))


if __name__ == "__main__":
    sys.exit(main())
