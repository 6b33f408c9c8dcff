"""From a mesh to a pattern that can be printed and sewn, and a look at what will come out."""

import sys
from pathlib import Path

import numpy as np

import devseg


def pear(around: int = 40, along: int = 30) -> tuple[np.ndarray, np.ndarray]:
    """A closed body; y is up."""
    t = np.linspace(0, np.pi, along + 1)[1:-1, None]
    a = np.linspace(0, 2 * np.pi, around, endpoint=False)[None, :]
    radius = np.sin(t) * (1 + 0.3 * np.cos(t))
    ring = [radius * np.cos(a), -1.5 * np.cos(t) + 0 * a, -radius * np.sin(a)]
    vertices = np.concatenate([np.stack(ring, -1).reshape(-1, 3), [[0, -1.5, 0], [0, 1.5, 0]]])
    faces = []
    for row in range(along - 2):
        for k in range(around):
            p, q = row * around + k, row * around + (k + 1) % around
            faces += [[p, q, q + around], [p, q + around, p + around]]
    bottom, top, last = len(vertices) - 2, len(vertices) - 1, (along - 2) * around
    for k in range(around):
        following = (k + 1) % around
        faces += [[bottom, following, k], [top, last + k, last + following]]
    return vertices, np.array(faces)


def main(out: Path) -> None:
    """Writes the pattern and the preview."""
    atlas = devseg.unwrap(*pear(), method="plush")
    pattern = devseg.pattern(
        atlas, height_mm=250, preset="sewing", page="a4", seam_allowance_mm=6, notch_spacing_mm=40
    )
    out.mkdir(parents=True, exist_ok=True)
    for warning in pattern.save(out / "pear.pdf"):
        print("warning:", warning)
    measures = pattern.measures()
    print(f"{measures['pieces_number']} pieces, {measures['area_mm2'] / 1e6:.3f} m2 of fabric")
    print(f"the sides of a seam differ by {measures['max_seam_mismatch_mm']:.2f} mm at most")
    toy = devseg.sewn_preview(atlas)
    print(f"sewn, it is {100 * toy.measures['mean_distance_share']:.1f} % from the model")
    np.savez(out / "sewn.npz", vertices=toy.vertices, faces=toy.faces, distance=toy.distance)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
