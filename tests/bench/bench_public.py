"""Runs the pipeline over a folder of meshes and prints a markdown table for docs/benchmarks.md.

    .venv/bin/python tests/bench/bench_public.py [MESH_OR_FOLDER...] [--charts N] ...

The default folder is public/ in DEVSEG_DATA. The figures come from the independent evaluator
(DEVSEG_EVALUATOR), so that they cannot flatter us; the seconds are ours, per stage.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import sys
from pathlib import Path
from typing import Any

from devseg import DevsegError, load_plugins
from devseg.cli import add_run_options
from devseg.load import load_mesh
from devseg.methods import METHODS
from devseg.pipeline import RunOptions, Session, flatten_mesh
from devseg.progress import Progress

SHARED = Path(__file__).resolve().parents[3] / "shared"
STAGES = ("segment", "flatten", "measure")
COLUMNS = (
    ("charts", "charts", "{:d}"),
    ("disks", "disks", "{:d}"),
    ("L2", "l2", "{:.4f}"),
    ("Linf", "linf", "{:.2f}"),
    ("flipped", "flipped", "{:d}"),
    ("self-overlapping", "self_overlapping_charts", "{:d}"),
    ("seams / √area", "seam_len", "{:.2f}"),
    ("packing", "packing_unit", "{:.3f}"),
)


def load_evaluator() -> Any:
    path = Path(os.environ.get("DEVSEG_EVALUATOR", SHARED / "eval" / "evalatlas.py"))
    spec = importlib.util.spec_from_file_location("evalatlas", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def mesh_files(chosen: list[Path]) -> list[Path]:
    """The meshes among files and folders, smallest first."""
    data = Path(os.environ.get("DEVSEG_DATA", SHARED / "data"))
    found: list[Path] = []
    for path in chosen or [data / "public"]:
        found += [path] if path.is_file() else [*path.glob("*.ply"), *path.glob("*.obj")]
    return sorted(found, key=lambda p: (p.stat().st_size, p.name))


def row(path: Path, options: RunOptions, evaluator: Any) -> str:
    progress = Progress(path.stem)
    with progress.stage("load"):
        meshset = load_mesh(path).meshes
    flatten_mesh(Session(path, meshset), options, progress)
    mesh = meshset.current_mesh()
    found = evaluator.evaluate(
        mesh.vertex_matrix(),
        mesh.face_matrix(),
        mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2),
        mesh.face_custom_scalar_attribute_array("chart_id").astype(int),
    )
    cells = [path.stem, f"{mesh.face_number():,}"]
    cells += [form.format(found[key]) for _, key, form in COLUMNS]
    cells += [f"{progress.seconds[stage]:.2f}" for stage in STAGES]
    cells.append(f"{sum(progress.seconds.values()):.2f}")
    return " | ".join(cells)


def main() -> int:
    """Prints one row for each mesh; returns 1 if any failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input", nargs="*", type=Path)
    add_run_options(parser)
    args = parser.parse_args()
    method = METHODS[args.method]
    segmentation = {
        parameter: getattr(args, option)
        for option, parameter in method.options.items()
        if getattr(args, option) is not None
    }
    options = RunOptions(Path(), method, segmentation, args.flatten or method.flatten, ("svg",), {})
    evaluator = load_evaluator()
    load_plugins()
    heads = ["mesh", "faces", *(head for head, _, _ in COLUMNS)]
    heads += [f"{stage} s" for stage in STAGES] + ["total s"]
    print(f"| {' | '.join(heads)} |\n|---|{'--:|' * (len(heads) - 1)}")
    failed = False
    for path in mesh_files(args.input):
        try:
            print(f"| {row(path, options, evaluator)} |", flush=True)
        except DevsegError as error:
            failed = True
            print(f"| {path.stem} | {error} |", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
