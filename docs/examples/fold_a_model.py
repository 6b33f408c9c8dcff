"""Papercraft: charts that are deformed a little, until they unfold without any stretch."""

import sys
from pathlib import Path

import numpy as np

import devseg


def gem(around: int = 14, along: int = 7) -> tuple[np.ndarray, np.ndarray]:
    """A coarse, uneven ball, open at both ends, as people fold it."""
    t = np.linspace(0.5, np.pi - 0.5, along)[:, None]
    a = np.linspace(0, 2 * np.pi, around, endpoint=False)[None, :]
    radius = 1 + 0.15 * np.cos(3 * a) * np.sin(t)
    ring = [radius * np.sin(t) * np.cos(a), radius * np.cos(t), radius * np.sin(t) * np.sin(a)]
    p = (np.arange(along - 1)[:, None] * around + np.arange(around)[None, :]).ravel()
    q = (np.arange(along - 1)[:, None] * around + (np.arange(around) + 1) % around).ravel()
    faces = [np.stack([p, q, q + around], -1), np.stack([p, q + around, p + around], -1)]
    return np.stack(ring, -1).reshape(-1, 3), np.concatenate(faces)


def main(out: Path) -> None:
    """Writes the pattern."""
    charts = devseg.segment(*gem(), method="papercraft", charts_number=6)
    flat = devseg.deform(charts)
    moved = np.linalg.norm(flat.vertices - charts.vertices, axis=1)
    print(f"vertices moved by {moved.max():.3f} at most")
    print(f"charts are {flat.measures['residual']:.0e} rad from developable")
    atlas = devseg.unwrap(flat.vertices, flat.faces, charts=flat)
    print(f"L2 stretch {atlas.measures['l2_stretch']:.9f}")
    pattern = devseg.pattern(atlas, longest_mm=180, preset="papercraft", page="a4")
    out.mkdir(parents=True, exist_ok=True)
    pattern.save(out / "gem.pdf")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
