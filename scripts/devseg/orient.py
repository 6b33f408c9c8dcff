"""Solids whose faces look inwards: their pieces would be mirror images, their folds reversed."""

from __future__ import annotations

import numpy as np


def is_inside_out(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Whether a mesh is closed, consistently oriented, and encloses a negative volume.

    Vertices at one place count as one. Meshes with borders have no inside.

    Args:
        vertices: #V by 3.
        faces: #F by 3.
    """
    corners = vertices[faces]
    # About the middle, as large coordinates would drown the volume.
    a, b, c = np.moveaxis(corners - corners.reshape(-1, 3).mean(axis=0), 1, 0)
    if np.einsum("fk,fk->", np.cross(a, b), c) >= 0:
        return False
    # -0 and 0 are one place.
    rows = np.ascontiguousarray(vertices + 0.0).view(np.dtype((np.void, vertices.itemsize * 3)))
    _, place = np.unique(rows.ravel(), return_inverse=True)
    welded = place.ravel()[faces].astype(np.int64)
    start, end = welded.ravel(), np.roll(welded, -1, axis=1).ravel()
    count = len(vertices)
    forth, back = np.sort(start * count + end), np.sort(end * count + start)
    return bool((forth == back).all() and (np.diff(forth) > 0).all())
