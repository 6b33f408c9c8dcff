"""Processor seconds of D-Charts, stage by stage, beside those of uvunwrap, with what came out.

    pip install uvunwrap==0.3.0
    OMP_NUM_THREADS=1 taskset -c 0 .venv/bin/python tests/bench/bench_speed.py [MESH_OR_FOLDER...]

The default folder is public/ in DEVSEG_DATA. Each of both works on each mesh in turn, --runs times;
the median counts. Without uvunwrap its column is empty.
"""

from __future__ import annotations

import argparse
import importlib
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from devseg import host, load_plugins
from devseg.load import load_mesh
from devseg.methods import EFFORTS

SEGMENT = "compute_segmentation_dcharts_per_face"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"
PACK = "apply_texcoord_chart_packing_per_wedge"
MEASURE = "get_parametrization_measures"
STAGES = ("segment", "flatten", "pack")


def mesh_files(chosen: list[Path]) -> list[Path]:
    """The meshes among files and folders, smallest first."""
    found: list[Path] = []
    for path in chosen or [Path(os.environ["DEVSEG_DATA"]) / "public"]:
        found += [path] if path.is_file() else [*path.glob("*.ply"), *path.glob("*.obj")]
    return sorted(found, key=lambda p: (p.stat().st_size, p.name))


def seconds(work: Callable[[], Any]) -> float:
    start = time.process_time()
    work()
    return time.process_time() - start


def ours(path: Path, charts: int, effort: str) -> tuple[dict[str, float], dict[str, Any]]:
    """Seconds of each stage, and measures."""
    meshes = load_mesh(path).meshes
    with host.captured():
        taken = (
            seconds(lambda: meshes.apply_filter(SEGMENT, charts_number=charts)),
            seconds(lambda: meshes.apply_filter(FLATTEN, pack=False)),
            seconds(lambda: meshes.apply_filter(PACK, effort=EFFORTS[effort])),
        )
        measures = meshes.apply_filter(MEASURE)
    return dict(zip(STAGES, taken, strict=True)), measures


def theirs(peer: Any, path: Path) -> tuple[float, int]:
    """Seconds, and charts."""
    mesh = load_mesh(path).meshes.current_mesh()
    arrays = peer.Mesh(
        mesh.vertex_matrix().astype(np.float32), mesh.face_matrix().astype(np.uint32)
    )
    start = time.process_time()
    atlas = peer.generate([arrays])
    return time.process_time() - start, atlas.chart_count


def row(path: Path, args: argparse.Namespace, peer: Any) -> tuple[str, float, float]:
    """The row, and the seconds of both."""
    stages: dict[str, list[float]] = {stage: [] for stage in STAGES}
    peer_seconds, peer_charts = [0.0], 0
    for _ in range(args.runs):
        taken, measures = ours(path, args.charts, args.effort)
        for stage, value in taken.items():
            stages[stage].append(value)
        if peer is not None:
            value, peer_charts = theirs(peer, path)
            peer_seconds.append(value)
    middle = {stage: statistics.median(values) for stage, values in stages.items()}
    total = sum(middle.values())
    other = statistics.median(peer_seconds[1:] or peer_seconds)
    cells = [
        path.stem,
        str(measures["charts_number"]),
        f"{measures['l2_stretch']:.4f}",
        f"{measures['linf_stretch']:.2f}",
        f"{measures['packing_efficiency']:.3f}",
        *(f"{middle[stage]:.2f}" for stage in STAGES),
        f"{total:.2f}",
        f"{other:.2f} ({peer_charts})" if peer is not None else "",
    ]
    return f"| {' | '.join(cells)} |", total, other


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input", nargs="*", type=Path)
    parser.add_argument("--charts", type=int, default=12)
    parser.add_argument("--effort", choices=EFFORTS, default="normal")
    parser.add_argument("--runs", type=int, default=5)
    args = parser.parse_args()
    load_plugins()
    try:
        peer = importlib.import_module("uvunwrap")
    except ImportError:
        peer = None
    heads = ["mesh", "charts", "L2", "L∞", "packing", *STAGES, "sum", "uvunwrap (charts)"]
    print(f"| {' | '.join(heads)} |\n|---|{'--:|' * (len(heads) - 1)}")
    totals = [0.0, 0.0]
    for path in mesh_files(args.input):
        text, *taken = row(path, args, peer)
        print(text, flush=True)
        totals = [a + b for a, b in zip(totals, taken, strict=True)]
    ratio = f", {totals[0] / totals[1]:.1f} times" if totals[1] else ""
    print(f"\n{totals[0]:.1f} s and {totals[1]:.1f} s in sum{ratio}")


if __name__ == "__main__":
    main()
