"""Exports meshes with every preset and checks the files with foreign readers.

Usage: python tests/bench/check_patterns.py DIR MESH...   (one line for each mesh and preset)
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

import numpy as np

import devseg
import pattern_files as files
from devseg import host

HEIGHT = 250.0
PRESETS = ("Plain", "Sewing", "Papercraft", "Laser")


def check(ms: object, folder: Path, name: str, preset: str, seams: list[float], hems: float) -> str:
    """Writes all formats, with and without pages, and measures what is in them."""
    found = {}
    seconds = 0.0
    sheets = []
    unnumbered = {}
    for page in ("none", "a4"):
        for extension in ("svg", "pdf", "dxf"):
            path = folder / f"{name}_{preset}_{page}.{extension}"
            start = time.perf_counter()
            result = ms.apply_filter(
                "export_pattern",
                output_file=str(path),
                preset=preset,
                page=page,
                height_mm=HEIGHT,
            )
            seconds += time.perf_counter() - start
            reader = {"svg": files.read_svg, "pdf": files.read_pdf, "dxf": files.read_dxf}
            found[page, extension] = reader[extension](path)
            if extension != "dxf":
                assert files.renders(path), path
        unnumbered[page] = result["unnumbered_seams_number"]
        sheets.append(result["sheets_number"])
        pages = 1 if page == "a4" else 999
        assert files.words_outside(folder / f"{name}_{preset}_{page}.pdf", pages) == []
    overlap = itself = twice = difference = 0.0
    wrong: dict[int, int] = {}
    for page in ("none", "a4"):
        svg = found[page, "svg"]
        cut = svg["cut"]
        overlap = max(overlap, files.largest_overlap(list(files.polygons(cut).values())))
        itself = max(itself, *(files.overlap_of_itself(ring) for ring in cut.rings))
        twice = max(twice, files.length_cut_twice(cut))
        lengths = sorted(part.length for part in cut.parts)
        outline = "1" if "1" in found[page, "dxf"] else "CUT"
        others = [found[page, "pdf"]["Cut"].parts]
        if outline == "CUT":
            others.append(found[page, "dxf"]["CUT"].parts)
        for parts in others:
            other = sorted(part.length for part in parts)
            assert len(other) == len(lengths)
            difference = max(difference, *np.abs(np.subtract(lengths, other)))
        if preset != "Plain":
            texts = svg["engrave" if preset == "Laser" else "numbers"].texts
            wrong |= files.wrong_counts(
                [t for t in texts if t[0].isdigit()], len(seams), unnumbered[page]
            )
    net = found["none", "svg"].get("sew", found["none", "svg"]["cut"])
    around = sum(p.length * (1 if p.closed else 2) for p in net.parts)
    whole = preset in ("Plain", "Sewing")
    against = around - 2 * sum(seams) - hems if whole else 0.0
    return (
        f"{name:<22} {preset:<11} {len(files.polygons(found['none', 'svg']['cut'])):>4} pieces "
        f"{sheets[1]:>3} sheets {seconds:5.2f} s  overlap {overlap:.4f} itself {itself:.4f} mm2 "
        f"twice {twice:.2f} formats {difference:.4f} seams {against:.2f} mm wrong {len(wrong)} "
        f"of {len(seams)}, without room {unnumbered['none']}"
    )


def main() -> None:
    """All meshes."""
    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for argument in sys.argv[2:]:
        ms = pymeshlab.MeshSet()
        ms.load_new_mesh(argument)
        if not ms.current_mesh().has_wedge_tex_coord():
            ms.apply_filter("compute_segmentation_dcharts_per_face")
            ms.apply_filter("compute_texcoord_parametrization_charts_per_wedge")
        measures = ms.apply_filter("get_pattern_measures", height_mm=HEIGHT)
        for preset in PRESETS:
            seams, hems = measures["seam_length_mm"], measures["hem_length_mm"]
            print(check(ms, folder, Path(argument).stem, preset, seams, hems), flush=True)


if __name__ == "__main__":
    main()
