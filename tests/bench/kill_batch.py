"""Kills a batch at random moments, goes on each time, and compares it with one that nobody killed.

    python tests/bench/kill_batch.py MESH... -o OUT --plugins build/release/plugins [--kills 10]

The whole group of processes gets SIGKILL: the batch, its workers and their children. After each
kill every result is looked at: whole or absent. At the end the reports must be the same bytes, and
so must all files but for the seconds that they tell. Prints a row for each kill.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
REPORT = ("report.csv", "index.html")
# Differs every time.
_TIMES = ("times.csv", "times.js")


def command(args: argparse.Namespace, out: Path) -> list[str]:
    """The batch, which writes into that folder."""
    words = [sys.executable, "-m", "devseg", "batch", *map(str, args.meshes), "-o", str(out)]
    return [*words, "--jobs", str(args.jobs), *args.options]


def start(words: list[str], plugins: Path) -> subprocess.Popen[bytes]:
    """Starts a batch as the leader of a group of its own."""
    return subprocess.Popen(
        words,
        env={
            **os.environ,
            "DEVSEG_PLUGIN_DIR": str(plugins.absolute()),
            "PYTHONPATH": str(ROOT / "scripts"),
        },
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def halves(out: Path) -> list[str]:
    """Meshes that have a record, and not all that it tells of."""
    found = []
    for record in (out / "records").rglob("*.json"):
        name = record.relative_to(out / "records").as_posix().removesuffix(".json")
        told = json.loads(record.read_text())
        files = {path.name for path in (out / "meshes" / name).glob("*")}
        if told["ending"] == "pattern":
            result = out / "meshes" / name / f"{Path(name).stem}.json"
            if not result.is_file():
                found.append(name)
                continue
            wanted = set(json.loads(result.read_text())["outputs"].values())
            if files != wanted or not (out / "pictures" / f"{name}.png").is_file():
                found.append(name)
        elif files:
            found.append(name)
    return found


def contents(out: Path) -> dict[str, object]:
    """All files of a batch by name, without seconds."""
    found: dict[str, object] = {}
    for path in sorted(p for p in out.rglob("*") if p.is_file() and p.name not in _TIMES):
        value: object = path.read_bytes()
        if path.suffix == ".json":
            value = json.loads(path.read_bytes())
            for name in ("seconds", "cpu_seconds", "memory_mb", "stages"):
                value.pop(name, None)
        found[path.relative_to(out).as_posix()] = value
    return found


def main() -> int:
    """Prints a row for each kill; 1 where the reports differ or a result was half."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+", type=Path)
    parser.add_argument("-o", "--out", required=True, type=Path)
    parser.add_argument("--plugins", required=True, type=Path)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    args, args.options = parser.parse_known_args()
    random.seed(args.seed)
    begin = time.monotonic()
    start(command(args, args.out / "whole"), args.plugins).wait()
    whole = time.monotonic() - begin
    killed = args.out / "killed"
    bad = 0
    for kill in range(args.kills):
        # Some of them come before the first mesh is done, some while reports are written.
        wait = random.uniform(0.05, max(0.3 * whole, 1.5))
        process = start(command(args, killed), args.plugins)
        time.sleep(wait)
        ended = process.poll() is not None
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        wrong = halves(killed) if killed.exists() else []
        bad += len(wrong)
        done = len(list((killed / "records").rglob("*.json")))
        what = "had ended" if ended else "killed"
        print(f"{kill + 1}: {what} after {wait:.2f} s, {done} done, half: {wrong or 'none'}")
    start(command(args, killed), args.plugins).wait()
    same = all(
        (killed / name).read_bytes() == (args.out / "whole" / name).read_bytes() for name in REPORT
    )
    one, other = contents(args.out / "whole"), contents(killed)
    differing = [name for name in one.keys() | other.keys() if one.get(name) != other.get(name)]
    print(f"reports: {'the same' if same else 'differ'}; files: {len(one)}, differing: {differing}")
    return int(bool(bad or differing) or not same)


if __name__ == "__main__":
    sys.exit(main())
