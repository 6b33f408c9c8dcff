"""A full disk and too little memory: a clear error, and nothing half-written."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import meshes
from conftest import ROOT

FORMATS = ["svg", "pdf", "dxf", "ply", "obj"]
LEAST = {"svg": 2000, "pdf": 2000, "dxf": 2000, "ply": 20000, "obj": 20000}


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


def run_with_file_size(limit: int, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """`devseg` where no file may grow beyond `limit` bytes, as on a disk without more room."""

    def lower() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return subprocess.run(
        [sys.executable, "-m", "devseg", *map(str, arguments)],
        cwd=ROOT,
        env={**environment(), "PYTHONDONTWRITEBYTECODE": "1"},
        preexec_fn=lower,
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.mark.parametrize("kind", FORMATS)
def test_a_full_disk_leaves_no_file(
    kind: str, obj: Callable[[meshes.Mesh, str], Path], tmp_path: Path
) -> None:
    mesh = obj(meshes.cylinder(around=60, along=30))
    done = run_with_file_size(
        LEAST[kind], "run", mesh, "-o", tmp_path / "out", "--formats", kind, "--method", "vsa",
        "--charts", "4",
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    errors = [line for line in done.stderr.splitlines() if "error" in line]
    assert len(errors) == 1 and errors[0].startswith("devseg: error: "), done.stderr
    assert "unexpected" not in errors[0]
    assert not (tmp_path / "out").exists()


def test_a_disk_without_room(obj: Callable[[meshes.Mesh, str], Path], tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(disk)]
    if os.geteuid() != 0 or subprocess.run(mount, capture_output=True).returncode != 0:
        pytest.skip("only root may make a small disk")
    try:
        done = subprocess.run(
            [sys.executable, "-m", "devseg", "run", obj(meshes.cylinder(around=60, along=30)),
             "-o", disk / "out", "--formats", "pdf,ply", "--method", "vsa", "--charts", "4"],
            cwd=ROOT, env=environment(), capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        assert done.returncode == 1, done.stderr
        assert "devseg: error: " in done.stderr and "unexpected" not in done.stderr
        assert list(disk.iterdir()) == []
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_too_little_memory_is_told_and_changes_nothing(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("resource_worker.py")), str(tmp_path)],
        # Threads have no memory in reserve then, and what is freed goes back.
        env={
            **environment(),
            "MALLOC_ARENA_MAX": "1",
            "MALLOC_MMAP_THRESHOLD_": "65536",
            "MALLOC_TRIM_THRESHOLD_": "65536",
        },
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    outcomes = json.loads(done.stdout)
    assert outcomes.pop("files") == ["pattern.pdf"]
    assert sum(map(len, outcomes.values())) > 6
    for name, attempts in outcomes.items():
        assert attempts[-1] == "done", name
        for outcome in attempts[:-1]:
            assert "expected enough memory for this mesh, found too little" in outcome
            assert "has changed" not in outcome
