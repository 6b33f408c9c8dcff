"""How far the two sides of each seam differ on paper: LPFB and Symmetric Dirichlet, 600 mm models.

Usage: PYTHONPATH=scripts python tests/bench/bench_seams.py MESH...
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import devseg
from devseg import host


def measure(path: Path, method: str) -> None:
    ms = host.pymeshlab().MeshSet()
    ms.load_new_mesh(str(path))
    ms.apply_filter("compute_segmentation_dcharts_per_face")
    ms.apply_filter("compute_texcoord_parametrization_charts_per_wedge", method=method)
    scale = 600.0 / ms.current_mesh().bounding_box().diagonal()
    row = [path.stem, method]
    for match in (False, True):
        start = time.perf_counter()
        found = ms.apply_filter("get_pattern_measures", mm_per_unit=scale, match_seams=match)
        seconds = time.perf_counter() - start
        if not match:
            row += [f"{found['pieces_number']}", f"{found['seams_number']}"]
        row += [
            f"{found['mismatched_seams_number']}",
            f"{found['max_seam_mismatch_mm']:.3f}",
            f"{found['max_seam_mismatch_percent']:.3f}",
        ]
    print("| " + " | ".join([*row, f"{seconds:.2f}"]) + " |", flush=True)


if __name__ == "__main__":
    devseg.load_plugins()
    print("| mesh | method | pieces | seams | off | mm | % | off, matched | mm | % | s |")
    for name in sys.argv[1:]:
        for method in ("LPFB", "Symmetric Dirichlet"):
            measure(Path(name), method)
