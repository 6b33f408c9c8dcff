"""`devseg.unwrap` on arrays beside the same filters by hand: processor seconds, in turns.

    PYTHONPATH=scripts python tests/bench/bench_arrays.py MESH... [--rounds 7]

Prints a row for each mesh: medians of both, and the median of the ratios of neighbours in time.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import devseg
from devseg import host
from devseg.load import load_mesh
from devseg.methods import METHODS
from devseg.pipeline import FLATTEN_FILTER, PARAMETRIZATION_MEASURES


def by_hand(meshes: Any, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """What users of pymeshlab would write; the texture coordinates."""
    with host.captured():
        meshes.add_mesh(host.pymeshlab().Mesh(vertices, faces))
        meshes.apply_filter(METHODS["dcharts"].filter)
        meshes.apply_filter(FLATTEN_FILTER)
        meshes.apply_filter(PARAMETRIZATION_MEASURES)
        mesh = meshes.current_mesh()
        mesh.face_custom_scalar_attribute_array("chart_id")
        mesh.face_custom_scalar_attribute_array("seam_edges")
        found = mesh.wedge_tex_coord_matrix()
        meshes.clear()
    return found.reshape(-1, 3, 2)


def main() -> int:
    """Prints a row for each mesh."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+", type=Path)
    parser.add_argument("--rounds", type=int, default=7)
    args = parser.parse_args()
    devseg.load_plugins()
    meshes = host.pymeshlab().MeshSet()
    for path in args.meshes:
        mesh = load_mesh(path).meshes.current_mesh()
        vertices, faces = mesh.vertex_matrix(), mesh.face_matrix()
        seconds: dict[str, list[float]] = {"filters": [], "unwrap": []}
        for turn in range(args.rounds):
            uv = {}
            # Each is first in half of the turns.
            for name in sorted(seconds, reverse=turn % 2 == 1):
                begin = time.process_time()
                if name == "filters":
                    uv[name] = by_hand(meshes, vertices, faces)
                else:
                    uv[name] = devseg.unwrap(vertices, faces).uv
                seconds[name].append(time.process_time() - begin)
            assert (uv["filters"] == uv["unwrap"]).all()
        ratios = [b / a for a, b in zip(*seconds.values(), strict=True)]
        one, other = (statistics.median(values) for values in seconds.values())
        print(
            f"{path.name}: filters {one:.3f} s, unwrap {other:.3f} s, "
            f"{100 * (statistics.median(ratios) - 1):+.1f} %",
            flush=True,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
