"""Papercraft: parts, displacement, angles and lengths, recomputed from the mesh that is written.

.venv/bin/python tests/bench/bench_papercraft.py MESH [--charts N] [--target-faces N]   a row each
"""

from __future__ import annotations

import argparse
import re
import tempfile
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components

from devseg.errors import DevsegError
from devseg.load import load_mesh
from devseg.methods import METHODS
from devseg.pipeline import RunOptions, Session, flatten_mesh
from devseg.plugins import load_plugins
from devseg.progress import Progress
from devseg.run_options import DEFORM
from devseg.simplify import simplify

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


NARROW = re.compile(r"(\d+) of \d+ pieces? ha(?:s|ve) less than 3 mm")
# Normals of one plane differ by less: what files with six digits tell.
PARALLEL = 1 - 0.5e-6
# Of the surface: flat regions that a person sees as one face.
SEEN = 1e-3


def inner_pairs(faces: np.ndarray) -> np.ndarray:
    """Half-edges 3 f + k of the edges that have two faces, #E by 2."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T)
    same = np.flatnonzero((ends[order][1:] == ends[order][:-1]).all(axis=1))
    return np.stack([order[same], order[same + 1]], axis=1)


def flat_share(points: np.ndarray, faces: np.ndarray, seams: np.ndarray, seen: float) -> float:
    """Share of the length of the cuts that runs within flat regions of `seen` of the surface."""
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(areas[:, None], 1e-300)
    pairs = inner_pairs(faces)
    f, g = (pairs // 3).T
    flat = (normals[f] * normals[g]).sum(axis=1) > PARALLEL
    links = coo_matrix((np.ones(flat.sum()), (f[flat], g[flat])), shape=(len(faces),) * 2)
    region = connected_components(links, directed=False)[1]
    large = np.bincount(region, areas) >= seen * areas.sum()
    k = pairs[:, 0] % 3
    lengths = np.linalg.norm(points[faces[f, k]] - points[faces[f, (k + 1) % 3]], axis=1)
    cut = (seams[f] >> k) & 1 == 1
    within = flat & large[region[f]]
    return float(lengths[cut & within].sum() / max(lengths[cut].sum(), 1e-300))


def unfolded_gap(points: np.ndarray, faces: np.ndarray, seams: np.ndarray) -> float:
    """How far faces come to lie apart that share an edge, unfolded one after the other.

    Over the diagonal of the box: as much as the sheet, folded back, misses the surface.
    """
    corners = points[faces]
    x = corners[:, 1] - corners[:, 0]
    y = corners[:, 2] - corners[:, 0]
    length = np.linalg.norm(x, axis=1)
    along = (x * y).sum(axis=1) / length
    height = np.linalg.norm(np.cross(x, y), axis=1) / length
    flat = np.stack([np.zeros(len(faces)), length, along + 1j * height], axis=1)
    pairs = inner_pairs(faces)
    pairs = pairs[(seams[pairs[:, 0] // 3] >> pairs[:, 0] % 3) & 1 == 0]
    both = np.concatenate([pairs, pairs[:, ::-1]])
    f, g = (both // 3).T
    graph = coo_matrix((np.ones(len(f)), (f, g)), shape=(len(faces),) * 2).tocsr()
    edge = {}
    for h, twin in both.tolist():
        edge[h // 3, twin // 3] = (h % 3, twin % 3)
    turn, shift = np.ones(len(faces), complex), np.zeros(len(faces), complex)
    for first in np.unique(connected_components(graph, directed=False)[1], return_index=True)[1]:
        order, before = breadth_first_order(graph, first, directed=False)
        for face in order[1:].tolist():
            other = before[face]
            k, m = edge[other, face]
            start, end = (turn[other] * flat[other, [k, (k + 1) % 3]] + shift[other]).tolist()
            own = flat[face, (m + 1) % 3] - flat[face, m]
            turn[face] = (start - end) / own
            turn[face] /= abs(turn[face])
            shift[face] = end - turn[face] * flat[face, m]
    places = turn[:, None] * flat + shift[:, None]
    k, m = (both % 3).T
    gap = np.abs(places[f, k] - places[g, (m + 1) % 3]).max(initial=0.0)
    return float(gap / np.linalg.norm(np.ptp(points, axis=0)))


def narrow_pieces(session: Session) -> int:
    """Pieces that are too narrow to be glued where the model is 250 mm long, as the export says."""
    points = session.meshes.current_mesh().vertex_matrix()
    scale = 250.0 / float(np.ptp(points, axis=0).max())
    with tempfile.TemporaryDirectory() as folder:
        session.export(Path(folder) / "p.svg", {"preset": "Papercraft", "mm_per_unit": scale})
    told = [NARROW.match(warning) for warning in session.warnings]
    return sum(int(found[1]) for found in told if found)


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
        try:
            print(row(path, args), flush=True)
        except DevsegError as error:
            print(f"| {path.stem} | {error}", flush=True)


def row(path: Path, args: argparse.Namespace) -> str:
    """The row of one mesh."""
    session = Session(path, load_mesh(path).meshes)
    if args.target_faces:
        simplify(session, args.target_faces)
    given = session.meshes.current_mesh().vertex_matrix().copy()
    options = RunOptions(
        Path(tempfile.gettempdir()),
        METHODS["papercraft"],
        {"charts_number": args.charts, "deform": DEFORM[args.deform]},
        "symmetric-dirichlet",
        ("ply",),
        {},
        deforms=args.deform != "never",
    )
    progress = Progress(path.stem)
    found = flatten_mesh(session, options, progress)
    mesh = session.meshes.current_mesh()
    points, faces = mesh.vertex_matrix(), mesh.face_matrix()
    seams = mesh.face_custom_scalar_attribute_array("seam_edges").astype(int)
    ids = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    moved, flat = found.get("deformation", UNMOVED), found["parametrization"]
    charts = found["method_results"]["charts_number"]
    shares = [flat_share(given, faces, seams, SEEN), flat_share(points, faces, seams, 0.0)]
    return (
        f"| {path.stem} | {len(faces):,} | {charts} | {flat['charts_number']} "
        f"| {100 * moved['mean_share']:.3f} | {100 * moved['largest_share']:.2f} "
        f"| {angle_residual(points, faces, seams):.1e} "
        f"| {unfolded_gap(points, faces, seams):.1e} | {flat['l2_stretch'] - 1:.0e} "
        f"| {slit_length(points, faces, seams, ids):.2f} "
        f"| {100 * shares[0]:.1f}, {100 * shares[1]:.1f} | {narrow_pieces(session)} "
        f"| {moved['added_intersections_number']} | {flat['overlapping_faces_number']} "
        f"| {progress.seconds['segment']:.1f} | {progress.seconds.get('deform', 0.0):.1f} |"
    )


if __name__ == "__main__":
    main()
