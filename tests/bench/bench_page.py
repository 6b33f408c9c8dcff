"""The page of patterns: its size, and when the model is drawn in headless Chromium.

Usage: python tests/bench/bench_page.py MESH...   (those without texture coordinates: D-Charts)

Chromium draws in software. A load lasts until the mark `model` of the page, when the frame with the
model was made; the first load, which starts the browser's processes, does not count. Processor time
is that of all of Chromium, until lists and sheet are there as well.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import devseg
from devseg import host

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))
import chromium

LOADS = 8


def processor_seconds(root: int) -> float:
    """Of a process and all that come from it, dead ones that were waited for included."""
    parent, ticks = {}, {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            parent[int(entry.name)] = int(fields[1])
            ticks[int(entry.name)] = sum(map(int, fields[11:15]))
    total = 0
    for process in ticks:
        above = process
        while above not in (root, 0):
            above = parent.get(above, 0)
        total += ticks[process] if above == root else 0
    return total / 100.0


def load(driven: Any, page: Path) -> tuple[float, float]:
    """Seconds until the model is drawn, and processor seconds until all is there."""
    root = driven.service.process.pid
    before = processor_seconds(root)
    driven.get(page.as_uri())
    while not driven.execute_script("return document.documentElement.dataset.ready"):
        time.sleep(0.05)
    mark = "return performance.getEntriesByName('model')[0].startTime"
    return driven.execute_script(mark) / 1000.0, processor_seconds(root) - before


def main() -> None:
    """All meshes."""
    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    driven = chromium.start()
    with tempfile.TemporaryDirectory() as folder:
        for argument in sys.argv[1:]:
            ms = pymeshlab.MeshSet()
            ms.load_new_mesh(argument)
            faces = ms.current_mesh().face_number()
            if not ms.current_mesh().has_wedge_tex_coord():
                ms.apply_filter("compute_segmentation_dcharts_per_face")
                ms.apply_filter("compute_texcoord_parametrization_charts_per_wedge", pack=False)
            page = Path(folder) / "page.html"
            ms.apply_filter("export_pattern", output_file=str(page), preset="Sewing", page="a4")
            loads = [load(driven, page) for _ in range(LOADS + 1)][1:]
            drawn = [seconds for seconds, _ in loads]
            processor = statistics.median(seconds for _, seconds in loads)
            print(
                f"| {Path(argument).stem} | {faces:,} | {page.stat().st_size / 1e6:.1f} MB "
                f"| {min(drawn):.2f} | {statistics.median(drawn):.2f} | {processor:.2f} |",
                flush=True,
            )
    driven.quit()


if __name__ == "__main__":
    main()
