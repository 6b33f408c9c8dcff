"""Seams on edges against smooth seams, and the outlines of both as patterns: a markdown table.

    bench_smooth_seams.py DATA/public [--method dcharts|plush] [NAME...]

D-Charts with 12 charts, flattened with Symmetric Dirichlet; plush seams with their defaults, with
LPFB. Preset Sewing, 250 mm high. The sew lines are measured by an outside evaluator of SVG files,
DEVSEG_SEAM_SHAPE, called as `FILE.svg --layer Sew --json`. Excess: the L2 stretch of the whole map,
less one.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from devseg import host
from devseg.methods import FLATTENINGS, METHODS
from devseg.pipeline import FLATTEN_FILTER, PARAMETRIZATION_MEASURES, SMOOTH_FILTER
from devseg.plugins import load_plugins

SHARED = Path(__file__).resolve().parents[3] / "shared"
EVALUATOR = Path(os.environ.get("DEVSEG_SEAM_SHAPE", SHARED / "eval" / "seam_shape.py"))
SEGMENTATION = {"dcharts": {"charts_number": 12}, "plush": {}}
SMOOTHING = {
    "dcharts": {"max_chart_l2_stretch": 1.02},
    "plush": {"max_strain": 0.2, "symmetric": True},
}


def segmented(path: Path, method: str) -> Any:
    meshes = host.pymeshlab().MeshSet()
    meshes.load_new_mesh(str(path))
    meshes.apply_filter(METHODS[method].filter, **SEGMENTATION[method])
    return meshes


def shape(meshes: Any, method: str, folder: Path) -> dict[str, float]:
    """Flattens the charts and exports them; measures of the map and of the sew lines."""
    meshes.apply_filter(FLATTEN_FILTER, method=FLATTENINGS[METHODS[method].flatten])
    measures = meshes.apply_filter(PARAMETRIZATION_MEASURES)
    file = folder / "pattern.svg"
    pattern = meshes.apply_filter(
        "export_pattern", output_file=str(file), preset="Sewing", height_mm=250.0
    )
    command = [sys.executable, str(EVALUATOR), str(file), "--layer", "Sew", "--json"]
    lines = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    return {
        "excess": measures["l2_stretch"] - 1.0,
        "strain": measures["strain_99"],
        "jag": lines["jag_share"],
        "waves": lines["waves"],
        "pieces": pattern["pieces_number"],
    }


def row(path: Path, method: str) -> str:
    with tempfile.TemporaryDirectory() as folder:
        meshes = segmented(path, method)
        ids = [
            meshes.current_mesh().face_custom_scalar_attribute_array(name)
            for name in ("chart_id", "seam_edges")
        ]
        faces = meshes.current_mesh().face_number()
        before = shape(meshes, method, Path(folder))
        again = host.pymeshlab().MeshSet()
        again.load_new_mesh(str(path))
        for name, values in zip(("chart_id", "seam_edges"), ids, strict=True):
            again.current_mesh().add_face_custom_scalar_attribute(values, name)
        start = time.perf_counter()
        made = again.apply_filter(SMOOTH_FILTER, **SMOOTHING[method])
        seconds = time.perf_counter() - start
        after = shape(again, method, Path(folder))
    seams = made["smooth_seams_number"] + made["kept_seams_number"]
    cells = [
        path.stem,
        f"{after['pieces']:.0f}",
        f"{before['jag']:.3f}, {after['jag']:.3f}",
        f"{before['waves']:.3f}, {after['waves']:.3f}",
        f"{made['seam_length'] / max(made['seam_length_before'], 1e-300):.3f}",
        f"{before['excess']:.5f}, {after['excess']:.5f}",
        f"{before['strain']:.3f}, {after['strain']:.3f}",
        f"{100 * made['new_faces_number'] / faces:.1f} %",
        f"{made['kept_seams_number']:.0f} / {seams:.0f}",
        f"{seconds:.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", help="beginnings of names; default: all")
    parser.add_argument("--method", choices=sorted(SEGMENTATION), default="dcharts")
    args = parser.parse_args()
    load_plugins()
    files = sorted(p for p in args.folder.iterdir() if p.suffix in (".ply", ".obj"))
    for path in files:
        if not args.names or path.stem.startswith(tuple(args.names)):
            print(row(path, args.method), flush=True)


if __name__ == "__main__":
    main()
