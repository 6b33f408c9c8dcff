"""The materials of an input as an MTL library, without the images that fit its old coordinates."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from devseg import collada, gltf, three_ds, threemf

# Statements of a material that name an image.
_IMAGES = re.compile(r"\s*(map_\w+|bump|disp|decal|refl|norm)\s", re.IGNORECASE)
_LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+(.+?)\s*$", re.MULTILINE)
# Formats whose materials are known by their colours.
_COLORS = {
    **dict.fromkeys(gltf.EXTENSIONS, gltf.material_colors),
    ".dae": collada.material_colors,
    ".3mf": threemf.material_colors,
    ".3ds": three_ds.material_colors,
}
# A material that nothing describes.
_PLAIN = ["Kd 0.8 0.8 0.8", "illum 1"]


def library(source: Path, names: Sequence[str]) -> str:
    """The text of a library with these materials, as the input describes them."""
    extension = source.suffix.lower()
    described: dict[str, list[str]] = {}
    if extension == ".obj":
        described = _of_obj(source)
    elif extension in _COLORS:
        described = {
            name: [f"Kd {r:.6g} {g:.6g} {b:.6g}", "illum 1"]
            for name, (r, g, b) in _COLORS[extension](source).items()
        }
    return "\n".join(
        "".join(f"{row}\n" for row in [f"newmtl {name}", *(described.get(name) or _PLAIN)])
        for name in names
    )


def _of_obj(source: Path) -> dict[str, list[str]]:
    described: dict[str, list[str]] = {}
    for named in _LIBRARY.findall(source.read_bytes()):
        file = source.parent / named.decode("utf-8", "replace").replace("\\", "/")
        if not file.is_file():
            continue
        rows: list[str] = []
        for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
            words = line.split(None, 1)
            if words[:1] == ["newmtl"] and len(words) == 2:
                rows = described.setdefault(words[1].strip(), [])
            elif words and not _IMAGES.match(line) and not words[0].startswith("#"):
                rows.append(line.strip())
    return described
