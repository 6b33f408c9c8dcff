"""Time and memory from 20,000 to 5,120,000 faces: prints a table and draws docs/images/growth.png.

    .venv/bin/python tests/bench/bench_growth.py [MESH] [--picture FILE]

The mesh (gargoyle_20000 in DEVSEG_DATA) is subdivided at the middle of its edges again and again,
with noise of 2 % of an edge, so that its faces are not coplanar. Each size has a process of its
own.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

import devseg
from devseg import host
from devseg.load import load_mesh

ROOT = Path(__file__).resolve().parents[2]
LEVELS = 5
STAGES = ("load", "segment", "flatten and pack", "export")
COLORS = ("#888888", "#1f77b4", "#2ca02c", "#d62728")
SIZE = (900, 560)


def larger(path: Path, level: int) -> tuple[np.ndarray, np.ndarray]:
    """The mesh with 4**level as many faces."""
    meshes = host.pymeshlab().MeshSet()
    meshes.load_new_mesh(str(path))
    if level:
        meshes.meshing_surface_subdivision_midpoint(
            iterations=level, threshold=host.pymeshlab().PercentageValue(0)
        )
    mesh = meshes.current_mesh()
    points, faces = mesh.vertex_matrix(), mesh.face_matrix()
    edges = points[faces[:, 0]] - points[faces[:, 1]]
    noise = 0.02 * np.linalg.norm(edges, axis=1).mean()
    return points + np.random.default_rng(1).normal(0, noise if level else 0, points.shape), faces


def one_size(path: Path, level: int) -> dict[str, float]:
    """Seconds of each stage, and the peak of memory in GB."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "mesh.ply"
        meshes = host.pymeshlab().MeshSet()
        meshes.add_mesh(host.pymeshlab().Mesh(*larger(path, level)))
        meshes.save_current_mesh(str(file))
        command = [sys.executable, __file__, "--file", str(file)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(done.stdout.splitlines()[-1])


def measure(file: Path) -> dict[str, float]:
    """All stages on one file, in this process."""
    devseg.load_plugins()
    marks = [time.perf_counter()]
    meshes = load_mesh(file).meshes
    marks.append(time.perf_counter())
    with host.captured():
        meshes.apply_filter("compute_segmentation_dcharts_per_face", charts_number=12)
        marks.append(time.perf_counter())
        meshes.apply_filter("compute_texcoord_parametrization_charts_per_wedge")
        marks.append(time.perf_counter())
        pattern = file.with_suffix(".svg")
        meshes.apply_filter("export_pattern", output_file=str(pattern))
        marks.append(time.perf_counter())
    found = dict(zip(STAGES, np.diff(marks).tolist(), strict=True))
    found["faces"] = meshes.current_mesh().face_number()
    found["GB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    return found


def draw(rows: list[dict[str, float]], picture: Path) -> None:
    """Seconds over faces, both in powers of ten; a thin line grows with the number of faces."""
    left, right, top, bottom = 70, SIZE[0] - 160, 30, SIZE[1] - 60
    low, high = np.log10([rows[0]["faces"], rows[-1]["faces"]])
    least, most = -2.0, 2.0

    def place(faces: float, seconds: float) -> tuple[float, float]:
        x = left + (right - left) * (np.log10(faces) - low) / (high - low)
        y = bottom - (bottom - top) * (np.log10(max(seconds, 0.01)) - least) / (most - least)
        return x, y

    image = Image.new("RGB", SIZE, "white")
    canvas = ImageDraw.Draw(image)
    for power in range(int(least), int(most) + 1):
        y = place(rows[0]["faces"], 10.0**power)[1]
        canvas.line([(left, y), (right, y)], fill="#dddddd")
        canvas.text((12, y - 6), f"{10.0**power:g} s", fill="black")
    for row in rows:
        x = place(row["faces"], 1.0)[0]
        canvas.line([(x, top), (x, bottom)], fill="#dddddd")
        canvas.text((x - 25, bottom + 10), f"{int(row['faces']):,}", fill="black")
    canvas.text((right - 40, bottom + 32), "faces", fill="black")
    for number, (stage, color) in enumerate(zip((*STAGES, "all"), (*COLORS, "black"), strict=True)):
        seconds = [row[stage] if stage != "all" else total(row) for row in rows]
        points = [place(row["faces"], s) for row, s in zip(rows, seconds, strict=True)]
        canvas.line(points, fill=color, width=3 if stage == "all" else 2)
        canvas.text((right + 12, top + 20 * number), stage, fill=color)
    first = rows[1]
    linear = [place(row["faces"], total(first) * row["faces"] / first["faces"]) for row in rows]
    canvas.line(linear, fill="#bbbbbb")
    canvas.text((right + 12, top + 100), "as many times", fill="#999999")
    canvas.text((right + 12, top + 114), "as faces", fill="#999999")
    image.save(picture, optimize=True)


def total(row: dict[str, float]) -> float:
    return sum(row[stage] for stage in STAGES)


def main() -> None:
    """All sizes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    data = Path(os.environ.get("DEVSEG_DATA", ROOT.parent / "shared" / "data"))
    parser.add_argument("mesh", nargs="?", type=Path, default=data / "public/gargoyle_20000.ply")
    parser.add_argument("--picture", type=Path, default=ROOT / "docs" / "images" / "growth.png")
    parser.add_argument("--file", type=Path, help="measure this file alone")
    args = parser.parse_args()
    if args.file:
        print(json.dumps(measure(args.file)))
        return
    print(f"| faces | {' s | '.join(STAGES)} s | all s | µs a face | GB |")
    print("|--:|" + "--:|" * (len(STAGES) + 3))
    rows = []
    for level in range(LEVELS):
        rows.append(one_size(args.mesh, level))
        row = rows[-1]
        stages = " | ".join(f"{row[stage]:.2f}" for stage in STAGES)
        share = 1e6 * total(row) / row["faces"]
        print(
            f"| {int(row['faces']):,} | {stages} | {total(row):.2f} | {share:.1f} "
            f"| {row['GB']:.2f} |",
            flush=True,
        )
    draw(rows, args.picture)


if __name__ == "__main__":
    main()
