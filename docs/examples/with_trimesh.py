"""A mesh of trimesh, unwrapped, as a GLB file with texture coordinates and a chequered texture."""

import sys
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

import devseg


def main(out: Path) -> None:
    """Writes the file."""
    mesh = trimesh.creation.capsule(height=2, radius=0.7, count=[24, 24])
    atlas = devseg.unwrap(*devseg.from_trimesh(mesh))
    textured = devseg.to_trimesh(atlas)
    squares = np.indices((64, 64)).sum(axis=0) % 2 * 120 + 100
    image = Image.fromarray(squares.astype(np.uint8)).resize((1024, 1024), Image.Resampling.NEAREST)
    textured.visual = trimesh.visual.TextureVisuals(uv=textured.visual.uv, image=image)
    out.mkdir(parents=True, exist_ok=True)
    textured.export(out / "capsule.glb")
    print(f"{atlas.charts_number} charts, {len(textured.vertices)} vertices")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
