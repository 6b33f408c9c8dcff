"""Makes the pictures of the documentation, into docs/images.

.venv/bin/python docs/pictures.py                 all
.venv/bin/python docs/pictures.py plush cutting   some

Meshes are the samples of the pymeshlab wheel, or shapes made here.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFont

from devseg import host
from devseg.load import load_mesh
from devseg.methods import FLATTENINGS, METHODS
from devseg.pipeline import (
    COLOR_FILTER,
    DEFORM_FILTER,
    FLATTEN_FILTER,
    SMOOTH_FILTER,
    Session,
    simplify,
)
from devseg.plugins import load_plugins
from devseg.quickstart import sample_mesh
from devseg.render import render_meshes, render_pair

IMAGES = Path(__file__).resolve().parent / "images"
# Pixels: the height of a panel. Colours of the palette: few shades, small files.
SIZE = 420
COLORS = 128
FONT = 17
# Of the sections that a toy is made in: red, green and blue.
SECTION_COLORS = (
    (0.94, 0.78, 0.45),
    (0.45, 0.67, 0.86),
    (0.87, 0.49, 0.45),
    (0.53, 0.75, 0.50),
    (0.71, 0.58, 0.80),
    (0.60, 0.60, 0.60),
)


# Meshes


def sample(name: str) -> Session:
    """A sample mesh of the pymeshlab wheel."""
    path = sample_mesh().parent / name
    meshes = load_mesh(path).meshes
    load_plugins()
    return Session(path, meshes)


def shape(name: str, vertices: np.ndarray, faces: np.ndarray) -> Session:
    """A mesh made here."""
    load_plugins()
    module = host.pymeshlab()
    meshes = module.MeshSet()
    meshes.add_mesh(module.Mesh(vertices, faces), name)
    return Session(Path(name), meshes)


def grid(rows: int, columns: int, closed: bool) -> np.ndarray:
    """The triangles of a grid of (rows + 1) by (columns + 1) vertices, or a torus of them."""
    height, width = (rows, columns) if closed else (rows + 1, columns + 1)
    faces = []
    for i in range(rows):
        for j in range(columns):
            a, b = i * width + j, i * width + (j + 1) % width
            c, d = ((i + 1) % height) * width + j, ((i + 1) % height) * width + (j + 1) % width
            faces += [(a, b, d), (a, d, c)]
    return np.array(faces)


def torus() -> Session:
    """A torus of 2,400 faces."""
    v, u = np.meshgrid(
        np.linspace(0, 2 * math.pi, 24, False),
        np.linspace(0, 2 * math.pi, 50, False),
        indexing="ij",
    )
    r = 1.0 + 0.42 * np.cos(v)
    points = np.stack([r * np.cos(u), 0.42 * np.sin(v), -r * np.sin(u)], axis=2)
    return shape("torus", points.reshape(-1, 3), grid(24, 50, True))


def hill() -> Session:
    """A curved sheet that no map keeps as it is, 3,200 faces."""
    y, x = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41), indexing="ij")
    z = 0.9 * np.exp(-3.5 * (x**2 + y**2)) + 0.25 * x * y
    points = np.stack([x, z, -y], axis=2)
    return shape("hill", points.reshape(-1, 3), grid(40, 40, False))


# Pictures


def data(session: Session) -> host.MeshData:
    """The arrays of the session's mesh."""
    return host.mesh_data(session.meshes.current_mesh())


def save(image: Image.Image, name: str) -> None:
    """Writes a small PNG, without the empty rows above and below."""
    file = IMAGES / f"{name}.png"
    empty = Image.new(image.mode, image.size, "white")
    box = ImageChops.difference(image, empty).getbbox()
    image = image.crop((0, max(box[1] - FONT, 0), image.width, min(box[3] + FONT, image.height)))
    image.quantize(COLORS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(
        file, optimize=True
    )
    print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")


def titled(panels: list[Image.Image], titles: list[str]) -> Image.Image:
    """Pictures side by side, each with its title below."""
    foot = 2 * FONT
    height = max(panel.height for panel in panels)
    image = Image.new("RGB", (sum(panel.width for panel in panels), height + foot), "white")
    draw = ImageDraw.Draw(image)
    font = ImageFont.load_default(size=FONT)
    x = 0
    for panel, title in zip(panels, titles, strict=True):
        image.paste(panel, (x, 0))
        draw.text(
            (x + panel.width / 2, height + foot / 2), title, fill="black", font=font, anchor="mm"
        )
        x += panel.width
    return image


def segmented(session: Session, method: str, **parameters: Any) -> Session:
    """The session after a method, deformation where the method asks for it, and flattening."""
    chosen = METHODS[method]
    session.apply(chosen.filter, **parameters)
    if chosen.deforms:
        session.apply(DEFORM_FILTER)
    session.apply(FLATTEN_FILTER, method=FLATTENINGS[chosen.flatten])
    session.call(COLOR_FILTER)  # parts may hang on other charts now
    return session


def pattern_side(session: Session, size: int) -> Image.Image:
    """The flat charts alone."""
    return render_pair(data(session), size).crop((size, 0, 2 * size, size))


def mesh_side(session: Session, size: int) -> Image.Image:
    """The mesh alone."""
    return render_pair(data(session), size).crop((0, 0, size, size))


def small(session: Session, faces: int) -> Session:
    """The session's mesh with few faces."""
    simplify(session, faces)
    return session


def dcharts() -> None:
    """The bunny."""
    save(render_pair(data(segmented(sample("bunny.obj"), "dcharts")), SIZE), "dcharts")


def t_flooding() -> None:
    """The bunny in charts of equal Gauss area."""
    save(
        render_pair(data(segmented(sample("bunny.obj"), "t-flooding", charts_number=12)), SIZE),
        "t_flooding",
    )


def papercraft() -> None:
    """A bunny to fold by hand."""
    session = small(sample("bunny.obj"), 700)
    save(render_pair(data(segmented(session, "papercraft", charts_number=12)), SIZE), "papercraft")


def plush_cow() -> None:
    """The cow to sew."""
    save(render_pair(data(segmented(sample("cow.obj"), "plush")), SIZE), "plush_cow")


def baselines() -> None:
    """The two methods that others are compared with."""
    made = [
        data(segmented(sample("bunny.obj"), method, charts_number=12))
        for method in ("vsa", "mcgim", "dcharts", "t-flooding")
    ]
    titles = ["vsa", "mcgim", "dcharts", "t-flooding"]
    save(render_meshes(made, titles, 300), "baselines")


def flattening() -> None:
    """One chart, flattened by each method."""
    panels, titles = [], []
    for word, method in FLATTENINGS.items():
        session = hill()
        session.apply("compute_seams_charts_to_disks_per_edge", cut_tips=False)
        session.apply("compute_color_by_chart_per_face")
        session.apply(FLATTEN_FILTER, method=method)
        if not panels:
            panels.append(mesh_side(session, 220))
            titles.append("on the surface")
        panels.append(shaded_grid(session, 220))
        titles.append(word)
    save(titled(panels, titles), "flattening")


def shaded_grid(session: Session, size: int) -> Image.Image:
    """The flat chart with the edges of every other row of its mesh, which show the distortion."""
    corners = data(session).texcoords
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    scale = 3 * size * 0.92 / float((high - low).max())
    points = (corners - (low + high) / 2) * scale * np.array([1, -1]) + 3 * size / 2
    image = Image.new("RGB", (3 * size, 3 * size), "white")
    draw = ImageDraw.Draw(image)
    for triangle in points:
        draw.polygon([tuple(p) for p in triangle], fill=(244, 196, 148))
    for number, triangle in enumerate(points):
        row, column, second = number // 80, number % 80 // 2, number % 2
        # Face (a, b, d) has the grid's edges a-b and b-d, face (a, d, c) has d-c and c-a.
        if not second and row % 4 == 0:
            draw.line([tuple(triangle[0]), tuple(triangle[1])], fill=(70, 60, 50), width=3)
        if second and column % 4 == 0:
            draw.line([tuple(triangle[2]), tuple(triangle[0])], fill=(70, 60, 50), width=3)
        if second and row == 39:
            draw.line([tuple(triangle[1]), tuple(triangle[2])], fill=(70, 60, 50), width=3)
        if not second and column == 39:
            draw.line([tuple(triangle[1]), tuple(triangle[2])], fill=(70, 60, 50), width=3)
    return image.resize((size, size), Image.Resampling.LANCZOS)


def cutting() -> None:
    """A torus cut open to a disk."""
    session = torus()
    session.apply("compute_seams_charts_to_disks_per_edge", cut_tips=False)
    session.apply("compute_color_by_chart_per_face")
    session.apply(FLATTEN_FILTER)
    save(render_pair(data(session), SIZE), "cutting")


def smooth_seams() -> None:
    """Seams on edges, and as smooth curves."""
    panels = []
    for smooth in (False, True):
        session = sample("bunny.obj")
        session.apply(METHODS["dcharts"].filter, charts_number=12)
        if smooth:
            session.apply(SMOOTH_FILTER)
        session.apply(FLATTEN_FILTER)
        panels.append(render_pair(data(session), SIZE))
    save(titled(panels, ["seams on edges", "smooth seams"]), "smooth_seams")


def with_selection(session: Session, size: int) -> Image.Image:
    """The mesh alone, its selected faces in red."""
    found = data(session)
    selected = session.meshes.current_mesh().face_selection_array()
    colors = found.colors.copy()
    colors[selected] = (0.85, 0.1, 0.1)
    return render_pair(replace(found, colors=colors), size).crop((0, 0, size, size))


def your_seams() -> None:
    """A seam where faces were selected."""
    session = sample("bunny.obj")
    meshes = session.meshes
    session.apply(METHODS["dcharts"].filter, charts_number=12)
    session.apply(FLATTEN_FILTER)
    corners = meshes.current_mesh().vertex_matrix()[meshes.current_mesh().face_matrix()]
    head = np.percentile(corners[:, :, 1].min(axis=1), 86)
    session.call("compute_selection_by_condition_per_face", condselect=f"min(y0, y1) > {head}")
    panels = [with_selection(session, SIZE)]
    session.apply("compute_charts_from_selected_edges_per_face")
    session.apply(FLATTEN_FILTER)
    panels += [mesh_side(session, SIZE), pattern_side(session, SIZE)]
    titles = ["select faces", "their border is a seam", "flat"]
    save(titled(panels, titles), "your_seams")


def packing() -> None:
    """Nesting, and first fit."""
    panels = []
    for count in (20, 90):
        session = sample("bunny.obj")
        session.apply(METHODS["t-flooding"].filter, charts_number=count)
        session.apply(FLATTEN_FILTER)
        panels.append(pattern_side(session, SIZE))
    save(titled(panels, ["20 charts: nested", "90 charts: first fit"]), "packing")


def deformation() -> None:
    """Charts before and after they became exactly developable."""
    before = small(sample("bunny.obj"), 1200)
    before.apply(METHODS["papercraft"].filter, charts_number=12)
    start = data(segmented(small(sample("bunny.obj"), 1200), "vsa", charts_number=1))
    before.apply(FLATTEN_FILTER)
    after = segmented(small(sample("bunny.obj"), 1200), "papercraft", charts_number=12)
    save(
        render_meshes(
            [start, data(before), data(after)], ["mesh", "charts and slits", "developable"], 320
        ),
        "deformation",
    )


def pieces() -> None:
    """The pattern of the cow as it is written."""
    session = small(sample("cow.obj"), 3000)
    segmented(session, "plush")
    file = IMAGES / "pieces.svg"
    session.export(file, {"preset": "Sewing", "height_mm": 200.0, "simplify_mm": 0.5})
    print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")


def assembly() -> None:
    """The sections of the cow, on the model and in its pattern."""
    session = segmented(sample("cow.obj"), "plush")
    with TemporaryDirectory() as folder:
        made = session.export(Path(folder) / "cow.svg", {"preset": "Sewing", "height_mm": 200.0})
    found = data(session)
    section = made["piece_section"].astype(np.int64)[found.charts]
    colors = np.array(SECTION_COLORS)[section % len(SECTION_COLORS)]
    save(render_pair(replace(found, colors=colors), SIZE), "assembly")


# The way of a mesh: stages in the order of a run, with the rooms that they live in.
STAGES = (
    (
        ("input gate", "mesh"),
        ("segmentation", "methods/…"),
        ("cuts to disks", "atlas"),
        ("deformation", "develop"),
    ),
    (
        ("flattening", "flatten/maps, energy"),
        ("repairs", "flatten/repair"),
        ("packing", "pack"),
        ("texture coordinates", "atlas"),
    ),
    (
        ("pieces and seams", "pattern"),
        ("sheet", "io_pattern/sheet"),
        ("file", "io_pattern/writers"),
    ),
)
CARRIED = (
    ("mesh, manifold and oriented", "a label for each face", "charts that are disks"),
    ("one map for each chart", "maps without overlaps", "one layout"),
    ("pieces in mm", "lines, marks, pages"),
)
ROW_TITLES = ("to charts", "to a layout", "to a file")
ROW_COLORS = ("#dbe9f6", "#fde8cf", "#dff0d8")


def way_of_a_mesh() -> None:
    """Stages, what goes from one to the next, and where the code is."""
    box, gap, tall, top = (178, 64), 70, 132, 44
    width = 4 * box[0] + 3 * gap + 40
    height = top + 3 * tall
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" font-family="sans-serif" font-size="14">',
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
        'markerHeight="7" orient="auto"><path d="M0 0 8 4 0 8z" fill="#444"/></marker></defs>',
        f'<rect width="{width}" height="{height}" fill="white"/>',
    ]
    text = '<text x="{}" y="{}" text-anchor="{}" fill="{}" {}>{}</text>'
    arrow = '<path d="{}" fill="none" stroke="#444" stroke-width="1.5" marker-end="url(#tip)"/>'
    for row, stages in enumerate(STAGES):
        y = top + row * tall
        title = escape(ROW_TITLES[row])
        lines.append(text.format(20, y - 12, "start", "#666", 'font-style="italic"', title))
        for column, (stage, room) in enumerate(stages):
            x = 20 + column * (box[0] + gap)
            middle = x + box[0] / 2
            lines.append(
                f'<rect x="{x}" y="{y}" width="{box[0]}" height="{box[1]}" rx="8" '
                f'fill="{ROW_COLORS[row]}" stroke="#888"/>'
            )
            lines.append(text.format(middle, y + 27, "middle", "#111", 'font-weight="bold"', stage))
            mono = 'font-family="monospace" font-size="12"'
            lines.append(text.format(middle, y + 48, "middle", "#444", mono, escape(room)))
            if column + 1 < len(stages):
                end = x + box[0]
                lines.append(arrow.format(f"M{end + 3} {y + 32}H{end + gap - 3}"))
            if column < len(CARRIED[row]):
                carried = escape(CARRIED[row][column])
                place = x + box[0] + gap / 2
                small_text = 'font-size="11.5"'
                lines.append(text.format(place, y + 82, "middle", "#666", small_text, carried))
                lines.append(
                    f'<path d="M{place} {y + 70}V{y + 40}" stroke="#bbb" stroke-dasharray="2 3"/>'
                )
        if row < 2:
            last = 20 + (len(stages) - 1) * (box[0] + gap) + box[0] / 2
            low, next_top = y + box[1], y + tall
            path = f"M{last} {low + 3}V{low + 34}H{20 + box[0] / 2 + 60}V{next_top - 3}"
            lines.append(arrow.format(path))
    lines.append("</svg>")
    (IMAGES / "way_of_a_mesh.svg").write_text("\n".join(lines) + "\n", encoding="utf-8")


PICTURES: dict[str, Callable[[], None]] = {
    function.__name__: function
    for function in (
        way_of_a_mesh,
        dcharts,
        t_flooding,
        papercraft,
        plush_cow,
        baselines,
        flattening,
        cutting,
        smooth_seams,
        your_seams,
        packing,
        deformation,
        pieces,
        assembly,
    )
}


def main() -> None:
    """Makes the pictures that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("name", nargs="*", help=", ".join(PICTURES))
    for name in parser.parse_args().name or PICTURES:
        PICTURES[name]()


if __name__ == "__main__":
    main()
