"""Records what every filter makes of meshes, byte by byte, and compares two such records.

.venv/bin/python tests/bench/results.py record OUT.json [MESH...] [--methods M...]
    [--plugins DIR] [--quick] [--jobs N]
.venv/bin/python tests/bench/results.py compare A.json B.json [--steps]

A record holds digests of the mesh, the results and the files after every step, and its CPU seconds,
for each mesh and method; what it holds already is not run again, unless it has failed. The default
meshes are those of public/ in DEVSEG_DATA. Comparing fails where anything differs that both hold.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import statistics
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from results_worker import RUNS

from devseg import plugin_paths

WORKER = Path(__file__).with_name("results_worker.py")
SHARED = Path(__file__).resolve().parents[3] / "shared"
QUICK_MESHES = 8
QUICK_FACES = 20_000
QUICK_PLUSH_FACES = 15_000


def run_apart(mesh: Path, run: str, timeout: float) -> dict[str, Any]:
    """What a process of its own has found: its steps, and how it failed."""
    # The date that files bear.
    environment = {**os.environ, "SOURCE_DATE_EPOCH": "0"}
    command = [sys.executable, str(WORKER), str(mesh), run]
    entry: dict[str, Any] = {}
    try:
        done = subprocess.run(command, env=environment, capture_output=True, timeout=timeout)
        output = done.stdout
        if done.returncode != 0:
            entry["failure"] = f"ended with {done.returncode}"
            print(done.stderr.decode(errors="replace")[-1000:], file=sys.stderr)
    except subprocess.TimeoutExpired as expired:
        output = expired.stdout or b""
        entry["failure"] = f"took more than {timeout:g} s"
    steps = [json.loads(line) for line in output.rpartition(b"\n")[0].splitlines()]
    return {**entry, "steps": {step.pop("step"): step for step in steps}}


def faces_number(path: Path) -> int:
    data = path.read_bytes()
    match = re.search(rb"^element face (\d+)", data, re.MULTILINE)
    return int(match[1]) if match else len(re.findall(rb"^f ", data, re.MULTILINE))


def record(args: argparse.Namespace) -> int:
    if args.plugins:
        os.environ["DEVSEG_PLUGIN_DIR"] = str(args.plugins.resolve())
    plugins = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in plugin_paths()}
    found = {"plugins": plugins, "entries": {}}
    if args.out.exists():
        found = json.loads(args.out.read_text(encoding="utf-8"))
        if found["plugins"] != plugins:
            raise SystemExit(f"{args.out} was recorded with other plugins; choose another file")
    public = Path(os.environ.get("DEVSEG_DATA", SHARED / "data")) / "public"
    meshes = args.mesh or [*public.glob("*.ply"), *public.glob("*.obj")]
    faces = {mesh: faces_number(mesh) for mesh in meshes}
    meshes = sorted(meshes, key=lambda mesh: (faces[mesh], mesh.name))
    if args.quick:
        # Of all sizes.
        small = [mesh for mesh in meshes if faces[mesh] <= QUICK_FACES]
        count = min(QUICK_MESHES, len(small))
        meshes = [small[(2 * k + 1) * len(small) // (2 * count)] for k in range(count)]
    jobs = {
        f"{mesh.name} {run}": (mesh, run)
        for mesh in meshes
        for run in args.methods
        if not (args.quick and run == "plush" and faces[mesh] > QUICK_PLUSH_FACES)
    }
    with ThreadPoolExecutor(args.jobs) as pool:
        running = {
            pool.submit(run_apart, *job, args.timeout): key
            for key, job in jobs.items()
            if "failure" in found["entries"].get(key, {"failure": "not run yet"})
        }
        for future in as_completed(running):
            entry = found["entries"][running[future]] = future.result()
            part = args.out.with_suffix(".part")
            part.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
            part.replace(args.out)
            seconds = sum(step["seconds"] for step in entry["steps"].values())
            print(f"{running[future]}: {seconds:.1f} s {entry.get('failure', '')}", flush=True)
    return 0


def differences(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """The parts in which two steps differ, with the values where they are short."""
    if not one or not other:
        return ["only in A"] * bool(one) + ["only in B"] * bool(other)
    found = []
    for part in sorted((one.keys() | other.keys()) - {"seconds"}):
        a, b = one.get(part, "nothing"), other.get(part, "nothing")
        if a != b:
            found.append(part if len(a) == len(b) == 64 else f"{part}: {a} -> {b}")
    return found


def compare(args: argparse.Namespace) -> int:
    a, b = (json.loads(path.read_text(encoding="utf-8"))["entries"] for path in (args.a, args.b))
    common = [key for key in a if key in b]
    differing = 0
    # CPU seconds of both by method or step, a pair for each mesh.
    seconds: defaultdict[str, list[list[float]]] = defaultdict(list)
    for key in common:
        run = key.rsplit(" ", 1)[1]
        one, other = (
            {"process": {"failure": entry.get("failure", "none")}, **entry["steps"]}
            for entry in (a[key], b[key])
        )
        pairs: defaultdict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
        found = []
        for step in one | other:
            x, y = one.get(step, {}), other.get(step, {})
            if parts := differences(x, y):
                found.append(f"{key}: {step}: {', '.join(parts)}")
            if "seconds" in x and "seconds" in y:
                pair = pairs[f"{run} {step}" if args.steps else run]
                pair[0] += x["seconds"]
                pair[1] += y["seconds"]
        for label, pair in pairs.items():
            seconds[label].append(pair)
        differing += bool(found)
        print("".join(f"{line}\n" for line in found), end="")
    print(f"{'CPU seconds':<36}{'meshes':>7}{'A':>10}{'B':>10}{'B / A':>8}{'median':>8}")
    for label, pairs_of_label in seconds.items():
        x, y = (sum(column) for column in zip(*pairs_of_label, strict=True))
        median = statistics.median(after / max(before, 1e-3) for before, after in pairs_of_label)
        ratio = y / max(x, 1e-3)
        print(f"{label:<36}{len(pairs_of_label):>7}{x:>10.1f}{y:>10.1f}{ratio:>8.3f}{median:>8.3f}")
    print(
        f"{differing} of {len(common)} common entries differ; "
        f"{len(a) - len(common)} only in A, {len(b) - len(common)} only in B"
    )
    return int(differing > 0 or not common)


def main() -> int:
    """Records or compares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True)
    sub = commands.add_parser("record")
    sub.add_argument("out", type=Path)
    sub.add_argument("mesh", nargs="*", type=Path)
    sub.add_argument("--methods", nargs="+", choices=RUNS, default=[*RUNS])
    sub.add_argument("--plugins", type=Path, help="folder of other plugins than those built here")
    sub.add_argument("--quick", action="store_true", help="eight meshes of all sizes up to 20,000")
    sub.add_argument("--jobs", type=int, default=1, help="processes at once; default: 1")
    sub.add_argument("--timeout", type=float, default=600, help="seconds for one; default: 600")
    sub.set_defaults(command=record)
    sub = commands.add_parser("compare")
    sub.add_argument("a", type=Path)
    sub.add_argument("b", type=Path)
    sub.add_argument("--steps", action="store_true", help="seconds of each step")
    sub.set_defaults(command=compare)
    args = parser.parse_args()
    return args.command(args)


if __name__ == "__main__":
    sys.exit(main())
