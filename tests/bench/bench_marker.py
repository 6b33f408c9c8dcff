"""Markers beside those of spyrrow (PyPI), for the same pieces, rotations, width and gap.

Usage: python tests/bench/bench_marker.py [--width-mm W] [--seconds S] [--grain free] MESH...

Meshes have texture coordinates, such as NAME.ply of `devseg run`. Instances of strip packing in
the JSON of jagua-rs, as those of ESICUP, are read as well: they are scaled to the width. One line
for each: pieces, the share of the cloth that both cover, and seconds. spyrrow works S seconds on
one core by the clock, and both CPU times are told: a busy machine needs more. It knows no holes, so
outlines count alone.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

import devseg
import pattern_files as files
from devseg import host


def outlines(svg: Path) -> list[Any]:
    """The outer cut line of each piece as it lies on the marker, in mm."""
    polygons = files.polygons(files.read_svg(svg)["cut"])
    return [polygon.exterior.coords[:-1] for polygon in polygons.values()]


def flat_model(instance: Path, width: float, folder: Path) -> Path:
    """The items of an instance as flat pieces of a model, which is its own texture; mm.

    The strip of an instance runs along x, ours along y.
    """
    from shapely import constrained_delaunay_triangles
    from shapely.geometry import Polygon

    found = json.loads(instance.read_text())
    scale = width / found["strip_height"]
    rows: list[str] = []
    count = 0
    left = 0.0
    for item in found["items"]:
        polygon = Polygon([(scale * y, scale * x) for x, y in item["shape"]["data"]])
        low, high = polygon.bounds[0], polygon.bounds[2]
        triangles = constrained_delaunay_triangles(polygon).geoms
        for _ in range(item["demand"]):
            place: dict[tuple[float, float], int] = {}
            faces = []
            for triangle in triangles:
                ring = list(triangle.exterior.coords)[:3]
                (a, b, c) = ring if triangle.exterior.is_ccw else ring[::-1]
                faces.append([place.setdefault(p, count + len(place) + 1) for p in (a, b, c)])
            for x, y in place:
                x += left - low
                rows += [f"v {x:.9g} {y:.9g} 0", f"vt {x / width:.9g} {y / width:.9g}"]
            rows += ["f " + " ".join(f"{v}/{v}" for v in face) for face in faces]
            count += len(place)
            left += high - low + 10.0
    path = folder / f"{instance.stem}.obj"
    path.write_text("\n".join(rows) + "\n")
    return path


def area(points: list[tuple[float, float]]) -> float:
    """Of a ring."""
    shifted = [*points[1:], points[0]]
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, shifted, strict=True))) / 2


def theirs(pieces: list[Any], args: argparse.Namespace) -> tuple[float, float]:
    """The length that spyrrow finds, and the CPU seconds that it took; its strip runs along x."""
    import spyrrow

    free = args.grain == "free"
    items = [
        spyrrow.Item(str(i), [(y, x) for x, y in ring], 1, None if free else [0.0, 180.0])
        for i, ring in enumerate(pieces)
    ]
    instance = spyrrow.StripPackingInstance("marker", args.width_mm, items)
    config = spyrrow.StripPackingConfig(
        total_computation_time=args.seconds,
        min_items_separation=args.gap_mm,
        num_workers=1,
        seed=0,
    )
    start = time.process_time()
    return instance.solve(config).width, time.process_time() - start


def main() -> int:
    """Prints the table; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+", type=Path)
    parser.add_argument("--width-mm", type=float, default=1400.0)
    parser.add_argument("--height-mm", type=float, default=400.0)
    parser.add_argument("--gap-mm", type=float, default=3.0)
    parser.add_argument("--copies", type=int, default=1)
    parser.add_argument("--seconds", type=int, default=10)
    parser.add_argument("--grain", choices=("kept", "free"), default="kept")
    parser.add_argument("--effort", default="Normal")
    args = parser.parse_args()
    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    differences = []
    for mesh in args.meshes:
        ms = pymeshlab.MeshSet()
        with tempfile.TemporaryDirectory() as folder:
            is_instance = mesh.suffix == ".json"
            model = flat_model(mesh, args.width_mm, Path(folder)) if is_instance else mesh
            ms.load_new_mesh(str(model))
            svg = Path(folder) / "marker.svg"
            grain = "Texture v" if is_instance else "Best fit"
            size = {"mm_per_unit": 1.0} if is_instance else {"height_mm": args.height_mm}
            size |= {"seam_allowance_mm": 0.0, "preset": "Plain"} if is_instance else {}
            start = time.process_time()
            found = ms.apply_filter(
                "export_pattern",
                output_file=str(svg),
                labels=False,
                edge_numbers=False,
                **{"preset": "Sewing", **size},
                fabric_width_mm=args.width_mm,
                piece_gap_mm=args.gap_mm,
                copies=args.copies,
                effort=args.effort,
                grain="Free" if args.grain == "free" else grain,
            )
            seconds = time.process_time() - start
            pieces = outlines(svg)
        covered = sum(map(area, pieces))
        ours = covered / (args.width_mm * found["fabric_length_mm"])
        length, their_seconds = theirs(pieces, args)
        other = covered / (args.width_mm * length)
        differences.append(ours - other)
        print(
            f"{mesh.stem:28} {len(pieces):4} pieces: {100 * ours:5.1f} % in {seconds:5.1f} s, "
            f"spyrrow {100 * other:5.1f} % in {their_seconds:5.1f} s",
            flush=True,
        )
    print(f"median difference {100 * statistics.median(differences):+.1f} points")
    return 0


if __name__ == "__main__":
    sys.exit(main())
