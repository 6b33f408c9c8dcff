"""What a texture on paper costs: processor seconds and bytes of the files, with and without it.

.venv/bin/python tests/bench/bench_texture.py TEXTURED_MESH [--charts N] [--longest-mm L]
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from devseg.load import load_mesh
from devseg.pipeline import Session
from devseg.plugins import load_plugins

SEGMENT = "compute_segmentation_dcharts_per_face"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"


def main() -> None:
    """Prints one row for each file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mesh", type=Path)
    parser.add_argument("--charts", type=int, default=12)
    parser.add_argument("--longest-mm", type=float, default=250.0)
    args = parser.parse_args()
    load_plugins()
    session = Session(args.mesh, load_mesh(args.mesh).meshes)
    session.apply(SEGMENT, charts_number=args.charts)
    session.apply(FLATTEN)
    mesh = session.meshes.current_mesh()
    scale = args.longest_mm / float(np.ptp(mesh.vertex_matrix(), axis=0).max())
    paper = {"preset": "Papercraft", "page": "a4", "mm_per_unit": scale}
    with tempfile.TemporaryDirectory() as folder:
        for kind in ("pdf", "svg", "png"):
            for texture in ("None", "Automatic"):
                target = Path(folder) / f"{texture}.{kind}"
                start = time.process_time()
                found = session.export(target, {**paper, "texture": texture})
                seconds = time.process_time() - start
                size = sum(file.stat().st_size for file in Path(folder).glob(f"{texture}*.{kind}"))
                print(
                    f"| {args.mesh.stem} | {mesh.face_number():,} | {kind} | {texture} "
                    f"| {found['pages_number']} | {seconds:.2f} | {size / 1e6:.2f} |"
                )


if __name__ == "__main__":
    main()
