"""Showing progress, and cancelling after a while."""

import sys
import time
from pathlib import Path

import numpy as np

import devseg


def hills(size: int = 160) -> tuple[np.ndarray, np.ndarray]:
    """A landscape of 50,000 faces."""
    x, z = np.meshgrid(np.linspace(0, 9, size), np.linspace(0, 9, size), indexing="ij")
    vertices = np.stack([x, np.sin(x) * np.cos(z), -z], -1).reshape(-1, 3)
    p = (np.arange(size - 1)[:, None] * size + np.arange(size - 1)[None, :]).ravel()
    faces = [np.stack([p, p + size, p + size + 1], -1), np.stack([p, p + size + 1, p + 1], -1)]
    return vertices, np.concatenate(faces)


def main(out: Path) -> None:
    """Writes how long it took until the work was cancelled."""
    vertices, faces = hills()
    shown = -1

    def show(share: float, what: str) -> None:
        nonlocal shown
        if int(10 * share) > shown:
            shown = int(10 * share)
            print(f"{100 * share:3.0f} % {what}")

    devseg.segment(vertices, faces, progress=show)

    def patience(share: float, _: str) -> bool:
        return share < 0.2

    start = time.perf_counter()
    try:
        devseg.unwrap(vertices, faces, progress=patience)
    except devseg.Cancelled as error:
        print(error)
    out.mkdir(parents=True, exist_ok=True)
    text = f"cancelled after {time.perf_counter() - start:.1f} s\n"
    (out / "cancelled.txt").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
