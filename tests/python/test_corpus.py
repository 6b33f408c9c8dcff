"""Broken meshes: every filter and every method of the command line, as the manifest expects.

Worker processes take the files one after the other; a step that crashes or takes longer than a
minute is a failure, and a new worker goes on with the next file. DEVSEG_CORPUS=full takes every
file with every method and the meshes in good order as well.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

import hosts
from conftest import ROOT
from devseg.methods import METHODS

FULL = os.environ.get("DEVSEG_CORPUS") == "full"
LONGEST_STEP = 60.0  # seconds
BUSY = 5  # times as long, where a step has not had as many seconds of a processor
MOST_FACES = 14000  # of a file that takes part where time is short

# Their defects appear when vertices at the same place are joined; in the files they lie apart, so
# that there is nothing to repair and nothing to tell.
APART = {"real_elephant_holes.off", "real_wallhole.obj"}

# What people ask for, beside the defaults. One of them is run on each file where time is short.
REQUESTS = [
    ["--charts", "4", "--formats", "svg"],
    ["--preset", "sewing", "--height-mm", "200", "--seam-allowance-mm", "10", "--formats", "pdf"],
    ["--longest-mm", "300", "--max-piece-mm", "90", "--formats", "dxf,obj"],
    ["--preset", "papercraft", "--longest", "8in", "--page", "letter", "--formats", "pdf,svg"],
    ["--weld", "off", "--seams", "edges", "--up", "z", "--formats", "svg,ply"],
    ["--method", "vsa", "--charts", "3", "--target-faces", "200", "--formats", "svg"],
    ["--charts", "auto", "--flatten", "abf", "--mirror", "--edge-numbers", "--formats", "svg"],
]
# That with which a file once ended the program.
ENDED = {"real_chair_doubled.obj": REQUESTS[0]}

# What a deformation or a simulation looks for, and does not find on every mesh.
UNREACHED = ("angle sums of 2 pi", "a surface that does not run through", "a cloth that comes to")
# Filters on what somebody has chosen, which does not suit every mesh.
CHOOSING = ("apply_charts_", "compute_charts_from_", "transfer_texture_")

# Filters that others rely on come first; those that are not here follow in the order of the table.
FIRST = [
    "get_segmentation_measures",
    "get_parametrization_measures",
    "export_pattern",
    "compute_seams_charts_to_disks_per_edge",
    "compute_segmentation_dcharts_per_face",
    "compute_texcoord_parametrization_charts_per_wedge",
]

SMOOTH = "meshing_smooth_chart_seams"
# The last of all: faces that lie on others, which filters leave out, come apart from them.
CUT = "meshing_cut_along_seams"


def filter_names() -> list[str]:
    """All filters of the plugins: before there are charts and coordinates, and after."""
    names = [filter_["python_name"] for filter_ in hosts.declarations()]
    segmentations = [name for name in names if name.startswith("compute_segmentation")]
    last = (SMOOTH, FIRST[-1])  # as `devseg run` does it: coordinates come after the last cuts
    rest = [name for name in names if name not in (*segmentations, *last, CUT)]
    return [*FIRST[:4], *reversed(segmentations), *last, *rest, CUT]


def processor_seconds(pid: int) -> float:
    """What a process has used so far; 0 once it has ended."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except (OSError, IndexError):
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Worker:
    """One process that works through a list of files, watched step by step."""

    def __init__(self, folder: Path, order: dict[str, Any]) -> None:
        self.answer = folder / "answer.jsonl"
        self.scratch = folder / "scratch"
        folder.mkdir(exist_ok=True)
        self.order = {**order, "answer": str(self.answer), "folder": str(self.scratch)}
        self.failures: list[str] = []

    def run(self, files: list[Path]) -> list[dict[str, Any]]:
        """All files; the records of the steps that ended."""
        self.answer.write_text("")
        left = files
        while left:
            left = left[self._run_until_failure(left) :]
        return [record for record in self._records() if "end" in record]

    def _run_until_failure(self, files: list[Path]) -> int:
        """Returns how many files are finished with, the one that failed among them."""
        shutil.rmtree(self.scratch, ignore_errors=True)  # of a process that was stopped
        self.scratch.mkdir()
        process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("corpus_worker.py"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        )
        before = len(self._records("done"))
        process.stdin.write(json.dumps({**self.order, "files": [str(file) for file in files]}))
        process.stdin.close()
        size, since, used, hung = 0, time.monotonic(), 0.0, False
        while process.poll() is None and not hung:
            time.sleep(0.05)
            if self.answer.stat().st_size != size:
                size, since = self.answer.stat().st_size, time.monotonic()
                used = processor_seconds(process.pid)
            # On a busy machine a step takes longer than its work; one that waits forever works not.
            waited = time.monotonic() - since
            hung = waited > BUSY * LONGEST_STEP or (
                waited > LONGEST_STEP and processor_seconds(process.pid) - used > LONGEST_STEP
            )
        if hung:
            process.kill()
        status = process.wait()
        done = len(self._records("done")) - before
        if done == len(files):
            return done
        records = self._records()
        last = next((r for r in reversed(records) if "begin" in r), {"begin": "start"})
        how = f"took more than {LONGEST_STEP:.0f} s" if hung else f"ended with status {status}"
        self.failures.append(f"{files[done].name}: {last['begin']} {how}")
        return done + 1

    def _records(self, kind: str = "") -> list[dict[str, Any]]:
        lines = self.answer.read_text().splitlines()
        return [record for record in map(json.loads, lines) if not kind or kind in record]


def commands(file: Path, number: int, formats: str) -> list[list[str]]:
    """The options of the command lines that a file goes through."""
    by_method = [["--method", method, "--formats", formats] for method in METHODS]
    if FULL:
        return by_method + REQUESTS
    request = ENDED.get(file.name, REQUESTS[number % len(REQUESTS)])
    return [by_method[number % len(by_method)], request]


def run_corpus(files: list[Path], tmp_path: Path, formats: str) -> tuple[list[dict], list[str]]:
    """All files on two processes; the records of all steps, and what crashed or hung."""
    chosen = {file.name: commands(file, i, formats) for i, file in enumerate(files)}
    order = {"filters": filter_names(), "commands": chosen}
    # The large ones first, and an even share for both.
    by_size = sorted(files, key=lambda file: (-file.stat().st_size, file.name))
    workers = [Worker(tmp_path / f"worker{i}", order) for i in range(2)]
    with ThreadPoolExecutor(len(workers)) as pool:
        records = list(pool.map(lambda i: workers[i].run(by_size[i :: len(workers)]), range(2)))
    all_records = [record for own in records for record in own]
    slowest = sorted(all_records, key=lambda r: -r["seconds"])[:5]
    print("slowest:", [(r["file"], r["end"], r["seconds"]) for r in slowest])
    return all_records, [failure for worker in workers for failure in worker.failures]


def manifest(data: Path) -> dict[str, dict[str, Any]]:
    entries = json.loads((data / "bad" / "MANIFEST.json").read_text())
    return {entry["file"]: entry for entry in entries}


def is_answer(error: str) -> bool:
    """Whether a step gives up what cannot be computed for this mesh, and says so."""
    return any(f"expected {what}" in error for what in UNREACHED)


def is_taken(entry: dict[str, Any]) -> bool:
    return FULL or (entry["welded"] or {"F": 0})["F"] <= MOST_FACES


def warns(step: dict[str, Any]) -> bool:
    return "devseg: warning: " in step["stderr"]


def problems_of_file(expected: str, steps: list[dict[str, Any]]) -> list[str]:
    """What a file's steps did otherwise than its entry in the manifest expects."""
    problems = [f"{step['end']}: {p}" for step in steps for p in step.get("problems", [])]
    commands = [step for step in steps if step["end"].startswith("devseg ")]
    if expected == "reject":
        # To go on without what is broken is as good, if it is told.
        accepted = [s["end"] for s in commands if s["status"] == 0 and not warns(s)]
        problems += [f"{command}: accepted a mesh to be refused" for command in accepted]
        return problems
    problems += [
        f"{step['end']}: {step['stderr'].strip()}"
        for step in commands
        if step["status"] != 0 and not is_answer(step["stderr"])
    ]
    has_uv = False
    for step in steps:
        # Before the flattening there may be no coordinates, or such that lay nothing out.
        needs_uv = "'Charts: Flatten'" in step.get("error", "")
        answered = (needs_uv and not has_uv) or is_answer(step.get("error", ""))
        if step["end"].startswith(CHOOSING):
            answered = answered or ": expected " in step.get("error", "")
        if "error" in step and not answered:
            problems.append(f"{step['end']}: {step['error']}")
        has_uv = has_uv or step["end"] == FIRST[-1]
    if expected == "repair+warn":
        silent = [s["end"] for s in commands if s["status"] == 0 and not warns(s)]
        problems += [f"{command}: no word of the repair" for command in silent]
    return problems


def test_the_manifest_is_kept(data: Path, tmp_path: Path) -> None:
    entries = {name: e for name, e in manifest(data).items() if is_taken(e)}
    assert len(entries) >= (75 if FULL else 70)
    files = [data / "bad" / name for name in entries]
    records, failures = run_corpus(files, tmp_path, "svg,pdf,dxf,ply,obj" if FULL else "svg,ply")
    for name, entry in entries.items():
        steps = [record for record in records if record["file"] == name]
        assert steps, name
        expected = "process" if name in APART else entry["expect"]
        failures += [f"{name}: {p}" for p in problems_of_file(expected, steps)]
    assert not failures, "\n" + "\n".join(failures)


@pytest.mark.skipif(not FULL, reason="only with DEVSEG_CORPUS=full")
def test_meshes_in_good_order_are_processed(data: Path, tmp_path: Path) -> None:
    files = sorted(f for f in (data / "public").iterdir() if f.suffix in (".ply", ".obj"))
    records, failures = run_corpus(files, tmp_path, "svg,pdf,dxf,ply,obj")
    for file in files:
        steps = [record for record in records if record["file"] == file.name]
        failures += [f"{file.name}: {p}" for p in problems_of_file("process", steps)]
    assert not failures, "\n" + "\n".join(failures)


def test_a_crash_and_a_hang_are_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    worker = tmp_path / "corpus_worker.py"
    worker.write_text(
        "import json, os, sys, time\n"
        "order = json.loads(sys.stdin.read())\n"
        "def tell(**record):\n"
        "    with open(order['answer'], 'a') as file:\n"
        "        file.write(json.dumps(record) + '\\n')\n"
        "for file in order['files']:\n"
        "    tell(begin='a step', file=file)\n"
        "    assert not os.listdir(order['folder'])\n"
        "    if 'crash' in file:\n"
        "        os.abort()\n"
        "    if 'hang' in file:\n"
        "        os.mkdir(order['folder'] + '/left')\n"
        "        time.sleep(100)\n"
        "    tell(end='a step', file=file)\n"
        "    tell(done=file)\n"
    )
    monkeypatch.setattr(sys.modules[__name__], "__file__", str(tmp_path / "test_corpus.py"))
    monkeypatch.setattr(sys.modules[__name__], "LONGEST_STEP", 2.0)
    runner = Worker(tmp_path / "worker", {})
    records = runner.run([Path("a"), Path("crash"), Path("b"), Path("hang"), Path("c")])
    assert [record["file"] for record in records] == ["a", "b", "c"]
    assert runner.failures == [
        "crash: a step ended with status -6",
        "hang: a step took more than 2 s",
    ]


def test_no_filter_is_left_out() -> None:
    names = filter_names()
    assert {f["python_name"] for f in hosts.declarations()} == set(names)
    assert (ROOT / "tests" / "python" / "corpus_worker.py").is_file()
