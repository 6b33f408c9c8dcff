"""An atlas of a torus: texture coordinates, measures, and a mesh that renderers can take."""

import sys
from pathlib import Path

import numpy as np

import devseg


def torus(around: int = 60, across: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    r = 3 + np.cos(b)
    vertices = np.stack([r * np.cos(a), r * np.sin(a), np.sin(b)], axis=-1).reshape(-1, 3)
    p = u * across + v
    q = (u + 1) % around * across + v
    up = (v + 1) % across - v
    quads = np.stack([p, q, q + up, p + up], axis=-1).reshape(-1, 4)
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def main(out: Path) -> None:
    """Writes the arrays of the atlas."""
    vertices, faces = torus()
    atlas = devseg.unwrap(vertices, faces, max_l2_stretch=1.02, charts_number=0)
    print(f"{atlas.charts_number} charts, L2 stretch {atlas.measures['l2_stretch']:.4f}")
    print(f"{100 * atlas.measures['packing_efficiency']:.0f} % of the sheet are covered")
    for warning in atlas.warnings:
        print("warning:", warning)
    cut = atlas.cut()
    print(f"{len(vertices)} vertices have become {len(cut.vertices)} along the seams")
    out.mkdir(parents=True, exist_ok=True)
    np.savez(out / "torus.npz", vertices=cut.vertices, faces=cut.faces, uv=cut.uv)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
