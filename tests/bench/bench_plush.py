"""Plush seams on public models: patches, strain, symmetry, direction and the sewn preview.

    bench_plush.py DATA/public [--areas] [--picture FILE] [NAME...]

With --areas: judged by areas alone (max_strain 0) and flattened with LPFB Even Areas.

With a picture: each model, segmented by D-Charts into as many charts, and by Plush Toy Seams.

Symmetric: share of the seam length whose mirror image is within 2 % of the diagonal of a seam, in
the filter's plane; measured here, in the best of the three planes through the middle of the box.
Guided: as the filter tells, by its skeleton; and measured here: share of the seam length within
30 degrees of the axis of the body part around it (the direction in which the normals within a tenth
of the diagonal point least), on edges that bend by more than 15 degrees, or on concave ones; of the
D-Charts as well. Waviness and acute corners: see seam_shape.py.
"""

from __future__ import annotations

import argparse
import resource
import time
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab
from PIL import Image
from scipy.spatial import cKDTree
from seam_shape import acute_corners, waviness

import devseg
from devseg.host import mesh_data
from devseg.render import render_meshes

D_CHARTS = "compute_segmentation_dcharts_per_face"
PLUSH = "compute_segmentation_plush_seams_per_face"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"
NAMES = ("teddy", "penguin", "triceratops", "horse", "cheburashka", "bull")


def seam_edges(mesh: Any) -> np.ndarray:
    """Vertex pairs of all cut edges, each once."""
    faces = mesh.face_matrix()
    bits = mesh.face_custom_scalar_attribute_array("seam_edges").astype(int)
    pairs = [faces[(bits >> k) & 1 == 1][:, [k, (k + 1) % 3]] for k in range(3)]
    return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)


def symmetric_share(points: np.ndarray, edges: np.ndarray) -> float:
    """Share of the seam length that has a mirror image, in the best plane."""
    low, high = points.min(0), points.max(0)
    ends = points[edges]
    steps = np.linspace(0.0, 1.0, 6)[:, None, None]
    samples = (ends[:, 0] * (1 - steps) + ends[:, 1] * steps).reshape(-1, 3)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    tree = cKDTree(samples)
    best = 0.0
    for axis in range(3):
        image = ends.mean(1)
        image[:, axis] = low[axis] + high[axis] - image[:, axis]
        near = tree.query(image)[0] < 0.02 * np.linalg.norm(high - low)
        best = max(best, float(length[near].sum() / length.sum()))
    return best


def guided_share(points: np.ndarray, faces: np.ndarray, edges: np.ndarray) -> float:
    """Share of the seam length along the body's local axis, along creases or in concave places."""
    size = np.linalg.norm(points.max(0) - points.min(0))
    corners = points[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(area, 1e-300)[:, None]
    sides: dict[tuple[int, int], list[int]] = {}
    for f, face in enumerate(faces):
        for k in range(3):
            a, b = sorted((int(face[k]), int(face[(k + 1) % 3])))
            sides.setdefault((a, b), []).append(f)
    centers = corners.mean(1)
    tree = cKDTree(centers)
    guided = total = 0.0
    for a, b in edges:
        along = points[b] - points[a]
        length = float(np.linalg.norm(along))
        total += length
        pair = sides[(int(a), int(b))]
        bend = 0.0
        if len(pair) == 2:
            f, g = pair
            bend = float(np.degrees(np.arccos(np.clip(normals[f] @ normals[g], -1, 1))))
            if normals[f] @ (centers[g] - centers[f]) > 0.02 * np.linalg.norm(
                centers[g] - centers[f]
            ):
                guided += length
                continue
        near = tree.query_ball_point(points[a], 0.1 * size)
        # The axis of a limb is where the normals around it do not point.
        spread = (normals[near] * area[near, None]).T @ normals[near]
        axis = np.linalg.eigh(spread)[1][:, 0]
        if bend > 15.0 or abs(along @ axis) > np.cos(np.radians(30.0)) * length:
            guided += length
    return guided / total


def processor_seconds() -> float:
    """Processor time of this process so far, all threads."""
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def measure(path: Path, name: str, areas: bool) -> Image.Image:
    """Prints a row of the table; returns the model with D-Charts and with plush seams."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    start, used = time.perf_counter(), processor_seconds()
    found = meshes.apply_filter(PLUSH, **({"max_strain": 0.0} if areas else {}))
    seconds, used = time.perf_counter() - start, processor_seconds() - used
    mesh = meshes.current_mesh()
    points, faces, edges = mesh.vertex_matrix(), mesh.face_matrix(), seam_edges(mesh)
    meshes.apply_filter(FLATTEN, method="LPFB Even Areas" if areas else "LPFB")
    plush = mesh_data(mesh)
    measures = meshes.apply_filter("get_parametrization_measures")
    preview = meshes.apply_filter("generate_sewn_preview")
    meshes.load_new_mesh(str(path))
    meshes.apply_filter(D_CHARTS, charts_number=found["charts_number"])
    other = meshes.current_mesh()
    other_edges = seam_edges(other)
    meshes.apply_filter(FLATTEN)
    print(
        f"{name} {found['charts_number']} {found['darts_number']} "
        f"{measures['max_area_change']:.3f} {measures['strain_99']:.3f} "
        f"{measures['largest_strain']:.2f} {measures['mean_strain']:.3f} "
        f"{found['mirrored_share']:.2f} {symmetric_share(points, edges):.2f} "
        f"{found['guided_share']:.2f} {guided_share(points, faces, edges):.2f} "
        f"{guided_share(points, faces, other_edges):.2f} "
        f"{preview['mean_distance_share']:.4f} "
        f"{waviness(points, edges):.2f} {waviness(points, other_edges):.2f} "
        f"{acute_corners(points, edges)} {acute_corners(points, other_edges)} "
        f"{seconds:.1f} {used:.1f}",
        flush=True,
    )
    return render_meshes([mesh_data(other), plush], ["D-Charts", "plush seams"], size=360)


def in_columns(pictures: list[Image.Image], columns: int) -> Image.Image:
    """Pictures of one size in rows, from left to right."""
    width, height = pictures[0].size
    rows = -(-len(pictures) // columns)
    whole = Image.new("RGB", (width * columns, height * rows), "white")
    for i, picture in enumerate(pictures):
        whole.paste(picture, (i % columns * width, i // columns * height))
    return whole


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", default=NAMES)
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--areas", action="store_true")
    options = parser.parse_args()
    devseg.load_plugins()
    print(
        "model patches darts area strain-99 largest mean symmetric of-box guided by-normals "
        "d-charts preview waviness d-charts acute d-charts seconds processor",
        flush=True,
    )
    pictures = []
    for name in options.names:
        path = next(p for p in sorted(options.folder.iterdir()) if p.name.startswith(name))
        pictures.append(measure(path, name, options.areas))
    if options.picture is not None:
        in_columns(pictures, 2).quantize(128).save(options.picture, optimize=True)


if __name__ == "__main__":
    main()
