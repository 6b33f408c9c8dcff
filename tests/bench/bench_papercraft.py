"""Papercraft: parts, displacement, angles and lengths, recomputed from the mesh that is written.

.venv/bin/python tests/bench/bench_papercraft.py MESH [--charts N] [--target-faces N]   a row each
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np

from devseg.errors import DevsegError
from devseg.load import load_mesh
from devseg.methods import METHODS
from devseg.pipeline import RunOptions, Session, flatten_mesh
from devseg.plugins import load_plugins
from devseg.progress import Progress
from devseg.run_options import DEFORM

# What a run without a deformation says of it.
UNMOVED = {"mean_share": 0.0, "largest_share": 0.0, "added_intersections_number": 0}


def angle_residual(points: np.ndarray, faces: np.ndarray, seams: np.ndarray) -> float:
    """Largest difference to 2 pi around a vertex without cut or boundary edges, radians."""
    sums = np.zeros(len(points))
    outer = np.ones(len(points), bool)
    outer[faces.ravel()] = False
    pairs = []
    for k in range(3):
        a = points[faces[:, (k + 1) % 3]] - points[faces[:, k]]
        b = points[faces[:, (k + 2) % 3]] - points[faces[:, k]]
        cross = np.linalg.norm(np.cross(a, b), axis=1)
        np.add.at(sums, faces[:, k], np.arctan2(cross, (a * b).sum(axis=1)))
        edge = np.stack([faces[:, k], faces[:, (k + 1) % 3]], axis=1)
        outer[edge[(seams >> k) & 1 == 1]] = True
        pairs.append(np.sort(edge, axis=1))
    edges, counts = np.unique(np.concatenate(pairs), axis=0, return_counts=True)
    outer[edges[counts == 1]] = True
    return float(np.abs(sums - 2 * np.pi)[~outer].max(initial=0.0))


def slit_length(points: np.ndarray, faces: np.ndarray, seams: np.ndarray, ids: np.ndarray) -> float:
    """Length of the cut edges between faces of one chart, over the diagonal of the box."""
    length = 0.0
    first: dict[tuple[int, int], int] = {}
    for face in np.flatnonzero(seams):
        for k in range(3):
            if seams[face] >> k & 1:
                a, b = sorted((int(faces[face, k]), int(faces[face, (k + 1) % 3])))
                if (a, b) in first and ids[first[a, b]] == ids[face]:
                    length += float(np.linalg.norm(points[a] - points[b]))
                first[a, b] = face
    return length / float(np.linalg.norm(np.ptp(points, axis=0)))


def flat_share(points: np.ndarray, faces: np.ndarray, seams: np.ndarray) -> float:
    """Share of the length of the cuts that runs between faces of one plane."""
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    all_cuts = flat_cuts = 0.0
    first: dict[tuple[int, int], int] = {}
    for face in np.flatnonzero(seams):
        for k in range(3):
            if not seams[face] >> k & 1:
                continue
            a, b = sorted((int(faces[face, k]), int(faces[face, (k + 1) % 3])))
            if (a, b) in first:
                length = float(np.linalg.norm(points[a] - points[b]))
                all_cuts += length
                flat_cuts += length * (normals[first[a, b]] @ normals[face] > 1 - 0.5e-6)
            first[a, b] = face
    return flat_cuts / all_cuts if all_cuts else 0.0


def main() -> None:
    """Prints one row for each mesh."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mesh", nargs="+", type=Path)
    parser.add_argument("--charts", type=int, default=20)
    parser.add_argument("--target-faces", type=int)
    parser.add_argument("--deform", choices=DEFORM, default="auto")
    args = parser.parse_args()
    load_plugins()
    for path in args.mesh:
        session = Session(path, load_mesh(path).meshes)
        options = RunOptions(
            Path(tempfile.gettempdir()),
            METHODS["papercraft"],
            {"charts_number": args.charts, "deform": DEFORM[args.deform]},
            "symmetric-dirichlet",
            ("ply",),
            {},
            args.target_faces,
            deforms=args.deform != "never",
        )
        progress = Progress(path.stem)
        try:
            found = flatten_mesh(session, options, progress)
        except DevsegError as error:
            print(f"| {path.stem} | {error}")
            continue
        mesh = session.meshes.current_mesh()
        points, faces = mesh.vertex_matrix(), mesh.face_matrix()
        seams = mesh.face_custom_scalar_attribute_array("seam_edges").astype(int)
        ids = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
        moved, flat = found.get("deformation", UNMOVED), found["parametrization"]
        charts = found["method_results"]["charts_number"]
        print(
            f"| {path.stem} | {len(faces):,} | {charts} | {flat['charts_number']} "
            f"| {100 * moved['mean_share']:.3f} | {100 * moved['largest_share']:.2f} "
            f"| {angle_residual(points, faces, seams):.1e} | {flat['l2_stretch'] - 1:.0e} "
            f"| {slit_length(points, faces, seams, ids):.2f} "
            f"| {100 * flat_share(points, faces, seams):.1f} "
            f"| {moved['added_intersections_number']} | {flat['overlapping_faces_number']} "
            f"| {progress.seconds['segment']:.1f} | {progress.seconds.get('deform', 0.0):.1f} |"
        )


if __name__ == "__main__":
    main()
