"""Pages of A4 that patterns take, and the limit: a row of docs/benchmarks.md for each mesh.

Usage: python tests/bench/bench_pages.py [--method M] [--height-mm H] MESH...

Meshes without texture coordinates are cut by D-Charts or another method of `devseg run`.

The limit is the area inside all cut lines in pages, divided by 0.55, rounded up. A page is nearly
empty where pieces cover less than 5 % of it; the last one does not count.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from lxml import etree
from shapely import box, union_all

import devseg
import pattern_files as files
from devseg import host

METHODS = {
    "dcharts": ("compute_segmentation_dcharts_per_face", {}),
    "plush": ("compute_segmentation_plush_seams_per_face", {"method": "LPFB"}),
}
FORMAT = (190.0, 277.0)  # mm that can be printed on, with margins of
MARGIN = 10.0
PAGE = "{http://www.inkscape.org/namespaces/inkscape}page"


def shares(svg: Path) -> list[float]:
    """Of each page, what pieces cover."""
    pieces = union_all(list(files.polygons(files.read_svg(svg)["cut"]).values()))
    found = []
    for page in etree.parse(str(svg)).getroot().iter(PAGE):
        x, y = (float(page.get(name)) + MARGIN for name in ("x", "y"))
        window = box(x, y, x + FORMAT[0], y + FORMAT[1])
        found.append(pieces.intersection(window).area / (FORMAT[0] * FORMAT[1]))
    return found


def row(ms: Any, name: str, height: float, folder: Path) -> str:
    """Exports the current mesh."""
    svg = folder / "pattern.svg"
    parameters = {"preset": "Sewing", "page": "a4", "height_mm": height}
    start = time.process_time()
    result = ms.apply_filter("export_pattern", output_file=str(svg), **parameters)
    seconds = time.process_time() - start
    area = result["material_mm2"] / (FORMAT[0] * FORMAT[1])
    pages = int(result["paper_sheets_number"])
    limit = math.ceil(area / 0.55)
    covered = shares(svg)
    assert len(covered) == pages, (len(covered), pages)
    poor = sum(share < 0.05 for share in covered[:-1])
    over = " (over)" if pages > limit else ""
    return (
        f"| {name} | {int(result['pieces_number'])} | {area:.1f} | {limit} | {pages}{over} "
        f"| {poor} | {seconds:.1f} |"
    )


def main() -> None:
    """All meshes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--method", choices=METHODS, default="dcharts")
    parser.add_argument("--height-mm", type=float, default=300.0)
    parser.add_argument("meshes", nargs="+", type=Path)
    arguments = parser.parse_args()
    segmentation, flattening = METHODS[arguments.method]
    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    with tempfile.TemporaryDirectory() as folder:
        for path in arguments.meshes:
            ms = pymeshlab.MeshSet()
            ms.load_new_mesh(str(path))
            if not ms.current_mesh().has_wedge_tex_coord():
                ms.apply_filter(segmentation)
                ms.apply_filter(
                    "compute_texcoord_parametrization_charts_per_wedge", pack=False, **flattening
                )
            print(row(ms, path.stem, arguments.height_mm, Path(folder)), flush=True)


if __name__ == "__main__":
    main()
