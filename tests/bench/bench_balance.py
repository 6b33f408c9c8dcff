"""Balance of Gauss area and stretch of maps to the circle, for three segmentation methods.

    .venv/bin/python tests/bench/bench_balance.py [MESH...] [--charts N]

Prints a markdown row for each mesh: standard deviation of the charts' Gauss areas (steradians), its
share of the mean for t-flooding, and the mean L2 stretch over the charts of maps to the circle. The
default meshes are five of public/ in DEVSEG_DATA.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

from devseg import load_plugins
from devseg.load import load_mesh

SHARED = Path(__file__).resolve().parents[3] / "shared"
NAMES = ("gargoyle_20000", "horse_19996", "feline_41262", "rockerarm_20088", "fertility_9000")
METHODS = (
    "compute_segmentation_t_flooding_per_face",
    "compute_segmentation_variational_shape_approximation_per_face",
    "compute_segmentation_multi_chart_geometry_images_per_face",
)


def measure(path: Path, method: str, charts: int) -> tuple[float, float, float, float]:
    """Deviation and mean of the Gauss areas, mean stretch to the circle, seconds of the filter."""
    meshset = load_mesh(path).meshes
    start = time.process_time()
    meshset.apply_filter(method, charts_number=charts)
    seconds = time.process_time() - start
    segmentation = meshset.get_segmentation_measures()
    circle = meshset.get_circle_map_measures()
    return (
        segmentation["gauss_area_std"],
        segmentation["gauss_area_mean"],
        circle["circle_l2_stretch"],
        seconds,
    )


def main() -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input", nargs="*", type=Path)
    parser.add_argument("--charts", type=int, default=20)
    args = parser.parse_args()
    data = Path(os.environ.get("DEVSEG_DATA", SHARED / "data")) / "public"
    load_plugins()
    print("| mesh | t-flooding: Gauss area | VSA | MCGIM | circle | VSA | MCGIM | CPU s |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    for path in args.input or [data / f"{name}.ply" for name in NAMES]:
        rows = [measure(path, method, args.charts) for method in METHODS]
        share = 100.0 * rows[0][0] / rows[0][1]
        cells = [path.stem, f"{rows[0][0]:.2f} ({share:.1f} %)"]
        cells += [f"{row[0]:.2f}" for row in rows[1:]]
        cells += [f"{row[2]:.2f}" for row in rows]
        print(f"| {' | '.join(cells)} | {rows[0][3]:.2f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
