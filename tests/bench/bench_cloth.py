"""Pieces for each material, and two measures of their strain that know nothing of each other.

Usage: python tests/bench/bench_cloth.py [--method plush] [--height-mm H] [--materials A,B] MESH...

One line for each model and material: pieces; what the export tells (pieces above the limits, the
largest use of them by 99 % of a piece's area, and by a face, within the limits up to 1 and 2); and
the strain of the finished pieces as measured here: from the layer of 'Pattern: Generate Pieces',
whose triangles are compared with those of the model by their three edge lengths alone. Of 99 % of
the worst piece's area, and of the worst face, both longer or shorter.
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import devseg
from devseg import host
from devseg.methods import FLATTENINGS, METHODS

FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"


def strains(flat: np.ndarray, solid: np.ndarray) -> np.ndarray:
    """The largest strain of a line in each triangle (#F by 3 corners), on the solid over the flat.

    Squared lengths of lines are quadratic forms in barycentric directions: with e1, e2 two edges
    and E, F, G their products, the extreme ratios are the roots of det(A - t B) = 0.
    """

    def form(triangles: np.ndarray) -> tuple[np.ndarray, ...]:
        a, b, c = (
            ((triangles[:, i] - triangles[:, j]) ** 2).sum(1) for i, j in ((0, 1), (0, 2), (1, 2))
        )
        return a, (a + b - c) / 2, b

    e, f, g = form(solid)
    p, q, r = form(flat)
    area = p * r - q * q
    half = (e * r + g * p - 2 * f * q) / (2 * area)
    root = np.sqrt(np.maximum(0.0, half**2 - (e * g - f * f) / area))
    longest, shortest = np.sqrt(half + root), np.sqrt(np.maximum(0.0, half - root))
    return np.maximum(longest - 1, 1 - shortest)


def measured(meshes: Any, **parameters: Any) -> tuple[float, float]:
    """Strain of 99 % of the area of the worst finished piece, and of the worst face."""
    solid = meshes.current_mesh()
    number = meshes.current_mesh_id()
    height = np.ptp(solid.vertex_matrix()[:, 1])
    scale = parameters["height_mm"] / height
    corners = scale * solid.vertex_matrix()[solid.face_matrix()]
    meshes.apply_filter("generate_pattern_pieces", **parameters)
    layer = meshes.current_mesh()
    source = layer.face_custom_scalar_attribute_array("source_face").astype(int)
    piece = layer.face_custom_scalar_attribute_array("piece_id").astype(int)
    flat = layer.vertex_matrix()[layer.face_matrix()]
    meshes.set_current_mesh(number)
    # Pieces that were turned over have two corners exchanged.
    strain, other = strains(flat, corners[source]), strains(flat[:, [0, 2, 1]], corners[source])
    for p in np.unique(piece):
        if other[piece == p].sum() < strain[piece == p].sum():
            strain[piece == p] = other[piece == p]
    area = np.linalg.norm(
        np.cross(
            corners[source][:, 1] - corners[source][:, 0],
            corners[source][:, 2] - corners[source][:, 0],
        ),
        axis=1,
    )
    most = 0.0
    for p in np.unique(piece):
        order = np.argsort(strain[piece == p])
        share = np.cumsum(area[piece == p][order]) / area[piece == p].sum()
        most = max(most, strain[piece == p][order][np.searchsorted(share, 0.99)])
    return most, float(strain.max())


def main() -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshes", nargs="+", type=Path)
    parser.add_argument("--method", choices=("plush", "dcharts"), default="plush")
    parser.add_argument("--height-mm", type=float, default=300.0)
    parser.add_argument("--materials", default="fleece,minky,cotton,leather")
    parser.add_argument("--charts", type=int)
    args = parser.parse_args()
    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    method = METHODS[args.method]
    for path in args.meshes:
        for material in args.materials.split(","):
            meshes = pymeshlab.MeshSet()
            meshes.load_new_mesh(str(path))
            before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
            charts = {"charts_number": args.charts} if args.charts else {}
            made = meshes.apply_filter(method.filter, material=material, **charts)
            meshes.apply_filter(FLATTEN, method=FLATTENINGS["lpfb"])
            seconds = resource.getrusage(resource.RUSAGE_SELF).ru_utime - before
            with tempfile.TemporaryDirectory() as folder:
                found = meshes.apply_filter(
                    "export_pattern",
                    output_file=str(Path(folder) / "pattern.svg"),
                    preset="Sewing",
                    material=material,
                    height_mm=args.height_mm,
                )
            most, worst = measured(meshes, material=material, height_mm=args.height_mm)
            print(
                f"{path.stem:20} {material:8} {int(found['pieces_number']):4} pieces, "
                f"{int(found['pieces_above_limits_number']):3} above; use "
                f"{max(found['piece_limit_use']):.2f} and {max(found['piece_worst_use']):.2f}; "
                f"strain of 99 % {100 * most:5.2f} %, worst {100 * worst:5.2f} %; segmentation "
                f"{made['charts_number']:.0f} charts, {seconds:.0f} CPU s",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
