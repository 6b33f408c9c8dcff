"""The export filter: files of every format and preset, read by foreign readers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pypdf
import pytest

import meshes
import pattern_files as files
from devseg.cli import main

PRESETS = ("Plain", "Sewing", "Papercraft", "Laser")


@pytest.fixture(scope="module")
def flattened(pymeshlab: Any) -> Any:
    """A ball without poles, in several flat pieces."""
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(*meshes.sphere()))
    ms.compute_segmentation_dcharts_per_face(charts_number=6, merge_charts=False)
    ms.compute_texcoord_parametrization_charts_per_wedge()
    return ms


@pytest.fixture(scope="module")
def folded_cube(pymeshlab: Any) -> Any:
    """A cube whose net is a cross, by coordinates from elsewhere."""
    ms = pymeshlab.MeshSet()
    vertices, faces = meshes.cube()
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, w_tex_coords_matrix=_cross(vertices, faces)))
    return ms


def _square(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """A flat square of unit cells."""
    x, y = np.meshgrid(np.arange(cells + 1.0), np.arange(cells + 1.0))
    low = [r * (cells + 1) + c for r in range(cells) for c in range(cells)]
    faces = [(i, i + 1, i + cells + 2) for i in low] + [
        (i, i + cells + 2, i + cells + 1) for i in low
    ]
    return np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]), np.array(faces)


def _cross(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    # Sides of the cube by their normal, and how their corners lie in the net.
    nets = {
        (0, 0, 1): lambda p: (1 + p[0], 1 + p[1]),
        (1, 0, 0): lambda p: (2 + 1 - p[2], 1 + p[1]),
        (0, 0, -1): lambda p: (3 + 1 - p[0], 1 + p[1]),
        (-1, 0, 0): lambda p: (0 + p[2], 1 + p[1]),
        (0, 1, 0): lambda p: (1 + p[0], 2 + 1 - p[2]),
        (0, -1, 0): lambda p: (1 + p[0], 0 + p[2]),
    }
    wedges = []
    for face in faces:
        corners = vertices[face]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        wedges += [nets[tuple(round(n) for n in normal)](p) for p in corners]
    return np.array(wedges, dtype=float) / 4


@pytest.fixture
def export(tmp_path: Path) -> Callable[..., Path]:
    def make(ms: Any, extension: str, **parameters: Any) -> Path:
        path = tmp_path / f"toy.{extension}"
        ms.apply_filter("export_pattern", output_file=str(path), **parameters)
        assert sorted(p.name for p in tmp_path.iterdir() if p.is_file())
        return path

    return make


@pytest.mark.parametrize("page", ["none", "a4", "120x90"])
@pytest.mark.parametrize("preset", PRESETS)
def test_all_formats_show_the_same_lines(
    flattened: Any, export: Callable, preset: str, page: str
) -> None:
    options = {"preset": preset, "page": page, "mm_per_unit": 50.0}
    svg = files.read_svg(export(flattened, "svg", **options))
    pdf = files.read_pdf(export(flattened, "pdf", **options))
    dxf = files.read_dxf(export(flattened, "dxf", dxf_kind="Cutter", **options))
    lengths = sorted(part.length for part in svg["cut"].parts)
    assert len(lengths) > 3
    for other in (pdf["Cut"], dxf["CUT"]):
        found = sorted(part.length for part in other.parts)
        np.testing.assert_allclose(found, lengths, atol=0.1)


@pytest.mark.parametrize("preset", PRESETS)
def test_curves_are_as_long_as_the_lines_they_replace(
    flattened: Any, export: Callable, preset: str
) -> None:
    options = {"preset": preset, "mm_per_unit": 50.0, "dxf_kind": "Cutter"}
    name = "sew" if preset == "Sewing" else "cut"
    lines = files.read_svg(export(flattened, "svg", **options))[name].parts
    options |= {"curve_mm": 0.2}
    path = export(flattened, "svg", **options)
    assert " C " in path.read_text() and files.renders(path)
    readers = {"svg": files.read_svg, "pdf": files.read_pdf, "dxf": files.read_dxf}
    labels = {"svg": name, "pdf": name.capitalize(), "dxf": name.upper()}
    if name == "sew":
        labels |= {"pdf": "Sew line", "dxf": "SEW_LINE"}
    for extension, read in readers.items():
        path = export(flattened, extension, **options)
        curves = read(path)[labels[extension]].parts
        np.testing.assert_allclose(
            sorted(p.length for p in curves), sorted(p.length for p in lines), atol=0.1
        )
    assert b"SPLINE" in path.read_bytes()


def test_hems_have_an_allowance_of_their_own(pymeshlab: Any, export: Callable) -> None:
    vertices, faces = _square(4)
    wedges = np.array([vertices[v][:2] for face in faces for v in face], dtype=float)
    ms = pymeshlab.MeshSet()
    ms.add_mesh(pymeshlab.Mesh(vertices, faces, w_tex_coords_matrix=wedges))
    size = np.ptp(vertices, axis=0)[:2] * 30.0
    svg = files.read_svg(
        export(ms, "svg", mm_per_unit=30.0, seam_allowance_mm=5.0, hem_allowance_mm=20.0)
    )
    # A sheet is all hem.
    (ring,) = svg["cut"].rings
    np.testing.assert_allclose(np.ptp(ring.points, axis=0), size + 40.0, atol=0.01)
    assert ring.area == pytest.approx(np.prod(size + 40.0), rel=1e-5)


@pytest.mark.parametrize("page", ["none", "a4"])
@pytest.mark.parametrize("preset", PRESETS)
def test_pieces_do_not_touch(flattened: Any, export: Callable, preset: str, page: str) -> None:
    svg = files.read_svg(export(flattened, "svg", preset=preset, page=page, mm_per_unit=50.0))
    shapes = list(files.polygons(svg["cut"]).values())
    assert files.largest_overlap([shape.buffer(0.2) for shape in shapes]) == 0
    assert files.length_cut_twice(svg["cut"]) < 0.1
    for ring in svg["cut"].rings:
        assert files.overlap_of_itself(ring) < 0.01


@pytest.mark.parametrize("preset", PRESETS[1:])
def test_every_seam_is_written_twice(flattened: Any, export: Callable, preset: str) -> None:
    svg = files.read_svg(export(flattened, "svg", preset=preset, mm_per_unit=50.0))
    texts = svg["engrave" if preset == "Laser" else "numbers"].texts
    numbers = [text for text in texts if text[0].isdigit()]
    seams = flattened.apply_filter("get_pattern_measures", mm_per_unit=50.0)["seams_number"]
    assert seams > 5 and files.wrong_counts(numbers, seams) == {}


def test_sew_lines_are_as_long_as_the_seams(flattened: Any, export: Callable) -> None:
    svg = files.read_svg(export(flattened, "svg", preset="Sewing", mm_per_unit=50.0))
    plain = files.read_svg(export(flattened, "svg", mm_per_unit=50.0))
    sew = sorted(part.length for part in svg["sew"].parts)
    np.testing.assert_allclose(sew, sorted(part.length for part in plain["cut"].parts), atol=0.1)


def test_allowance_is_all_around(flattened: Any, export: Callable) -> None:
    options = {"seam_allowance_mm": 8.0, "corner_style": "Round", "mm_per_unit": 50.0}
    svg = files.read_svg(export(flattened, "svg", **options))
    cut = files.polygons(svg["cut"])
    sew = files.polygons(svg["sew"])
    assert len(cut) == len(sew) > 1
    for name, piece in sew.items():
        grown = cut[name.replace("-sew", "-cut")]
        assert grown.exterior.distance(piece) == pytest.approx(8.0, abs=0.05)
        assert piece.buffer(8.0, quad_segs=64).symmetric_difference(grown).area < 2e-3 * grown.area


def test_a_cube_to_fold(folded_cube: Any, export: Callable) -> None:
    options = {"preset": "Papercraft", "mm_per_unit": 40.0}
    svg = files.read_svg(export(folded_cube, "svg", **options))
    (ring,) = svg["cut"].rings
    # Seven seams with a tab each: the cross has 14 free edges. Their sides slope at 45 degrees,
    # a little less in the corners of the cross.
    assert ring.area == pytest.approx(6 * 1600 + 7 * 5 * (40 - 5), abs=5)
    assert sum(p.length for p in svg["mountain"].parts) == pytest.approx((5 + 7) * 40, abs=0.1)
    assert "valley" not in svg
    # Four seams are darts, whose sides meet at a corner of the cross: they have their number once.
    numbers = Counter(svg["numbers"].texts)
    assert set(numbers) == {f"{i}" for i in range(1, 8)}
    assert sorted(numbers.values()) == [1, 1, 1, 1, 2, 2, 2]


def test_pages_of_a_pdf(flattened: Any, export: Callable) -> None:
    path = export(flattened, "pdf", preset="Sewing", page="a4", mm_per_unit=120.0)
    reader = pypdf.PdfReader(path, strict=True)
    assert len(reader.pages) > 4
    for page in reader.pages:
        size = [float(v) / files.POINTS_PER_MM for v in page.mediabox[2:]]
        assert size == pytest.approx([210, 297], abs=0.01)
    first, last = reader.pages[0].extract_text(), reader.pages[-1].extract_text()
    assert "P01" in first and "seam numbers" in first
    assert "print at 100 %" in last
    count = int(last.split("page ")[1].split(" of ")[1].split()[0])
    texts = [page.extract_text() for page in reader.pages]
    for number in range(1, count + 1):
        assert any(f"page {number} of {count}" in text for text in texts)
    assert any("column 2" in text for text in texts), "nothing was tiled"
    assert reader.trailer["/Root"]["/ViewerPreferences"]["/PrintScaling"] == "/None"
    groups = reader.trailer["/Root"]["/OCProperties"]["/OCGs"]
    assert {"Cut", "Sew line"} <= {g.get_object()["/Name"] for g in groups}
    assert files.words_outside(path, pages=1) == []
    assert files.renders(path)


def test_names_in_other_scripts_are_drawn(flattened: Any, tmp_path: Path) -> None:
    name = "\u041c\u0435\u0434\u0432\u0435\u0434\u044c \u0142 \u03a9"
    path = tmp_path / f"{name}.pdf"
    flattened.apply_filter("export_pattern", output_file=str(path), page="a4", mm_per_unit=50.0)
    reader = pypdf.PdfReader(path, strict=True)
    assert all(name in page.extract_text() for page in reader.pages)
    fonts = reader.pages[0]["/Resources"]["/Font"]
    (glyphs,) = fonts["/F2"].get_object()["/DescendantFonts"]
    assert "/FontFile2" in glyphs.get_object()["/FontDescriptor"]
    assert path.stat().st_size < 1_000_000
    assert files.renders(path)
    far = "\u718a \u304f\u307e \uacf0 \u041c"  # Chinese, Japanese, Korean and Cyrillic
    path = tmp_path / f"{far}.pdf"
    flattened.apply_filter("export_pattern", output_file=str(path), page="a4", mm_per_unit=50.0)
    reader = pypdf.PdfReader(path, strict=True)
    assert all(far in page.extract_text() for page in reader.pages)
    fonts = reader.pages[0]["/Resources"]["/Font"]
    assert {"/F2", "/F3"} <= set(fonts)
    for name in ("/F2", "/F3"):  # glyph 0 is a box
        used = fonts[name].get_object()["/ToUnicode"].get_data().split(b"beginbfchar")[1]
        assert b"<0000> <" not in used
    assert path.stat().st_size < 1_000_000
    assert files.renders(path)
    plain = tmp_path / "bear.pdf"
    flattened.apply_filter("export_pattern", output_file=str(plain), page="a4", mm_per_unit=50.0)
    assert "/F2" not in pypdf.PdfReader(plain).pages[0]["/Resources"]["/Font"]


def test_apparel_dxf(flattened: Any, export: Callable) -> None:
    path = export(flattened, "dxf", preset="Sewing", mm_per_unit=50.0)
    text = path.read_bytes()
    assert max(text) < 128 and b"LWPOLYLINE" not in text and b"TABLES" not in text
    layers = files.read_dxf(path)
    pieces = flattened.apply_filter("get_pattern_measures", mm_per_unit=50.0)["pieces_number"]
    assert len([p for p in layers["1"].parts if p.closed]) == pieces
    assert len([t for t in layers["1"].texts if t.startswith("Piece Name:")]) == pieces
    assert all(":" in t for layer in layers.values() for t in layer.texts)
    assert layers["14"].rings and layers["4"].parts and layers["7"].parts
    assert all(t.startswith("SEAM: ") for t in layers["15"].texts)
    # As they are and mirrored, together as many as there are pieces.
    counts = [t.split(":")[1] for t in layers["1"].texts if t.startswith("Quantity:")]
    assert sum(int(n) for count in counts for n in count.split(",")) == pieces


def test_mirrored_patterns_are_mirrored(folded_cube: Any, export: Callable) -> None:
    plain = files.read_svg(export(folded_cube, "svg", mm_per_unit=40.0))["cut"].rings[0].points
    mirrored = files.read_svg(export(folded_cube, "svg", mm_per_unit=40.0, mirror=True))
    x = plain[:, 0]
    expected = np.column_stack([x.min() + x.max() - x, plain[:, 1]])
    found = mirrored["cut"].rings[0].points
    np.testing.assert_allclose(np.sort(found, axis=0), np.sort(expected, axis=0), atol=1e-3)


def test_same_bytes_again(flattened: Any, export: Callable) -> None:
    for extension in ("svg", "pdf", "dxf"):
        options = {"preset": "Papercraft", "page": "a4", "mm_per_unit": 60.0}
        first = export(flattened, extension, **options).read_bytes()
        assert export(flattened, extension, **options).read_bytes() == first


@pytest.mark.parametrize(
    ("name", "parameters", "message"),
    [
        ("x.bmp", {}, "output_file: expected .* found '.*x.bmp'"),
        ("x", {}, "output_file"),
        ("missing/x.svg", {}, "expected to write the file"),
        ("x.svg", {"mm_per_unit": 0.0}, "mm_per_unit: expected"),
        ("x.svg", {"mm_per_unit": float("nan")}, "mm_per_unit: expected"),
        ("x.pdf", {"page": "a9"}, "page: expected"),
        ("x.pdf", {"page": "300x"}, "page: expected"),
        ("x.pdf", {"page": "a4", "page_margin_mm": 120.0}, "page_margin_mm: expected"),
        ("x.pdf", {"page": "a4", "tiling": False, "mm_per_unit": 500.0}, "page: expected pieces"),
        ("x.svg", {"seam_allowance_mm": -1.0}, "seam_allowance_mm: expected"),
        ("x.svg", {"hem_allowance_mm": -2.0}, "hem_allowance_mm: expected"),
        ("x.svg", {"curve_mm": -0.1}, "curve_mm: expected"),
        ("x.svg", {"seam_allowance_mm": 5.0, "glue_tabs": True}, "glue_tabs: expected"),
    ],
)
def test_bad_input_leaves_no_file(
    flattened: Any,
    pymeshlab: Any,
    tmp_path: Path,
    name: str,
    parameters: dict[str, Any],
    message: str,
) -> None:
    with pytest.raises(pymeshlab.PyMeshLabException, match=message):
        flattened.apply_filter("export_pattern", output_file=str(tmp_path / name), **parameters)
    assert list(tmp_path.iterdir()) == []


def test_mesh_without_texture_coordinates_is_refused(
    meshset: Any, pymeshlab: Any, tmp_path: Path
) -> None:
    with pytest.raises(pymeshlab.PyMeshLabException, match="texture coordinates"):
        meshset(meshes.cube()).apply_filter(
            "export_pattern", output_file=str(tmp_path / "none.svg")
        )
    assert list(tmp_path.iterdir()) == []


def test_saving_a_mesh_takes_the_same_parameters(flattened: Any, tmp_path: Path) -> None:
    saved = tmp_path / "saved.pdf"
    flattened.save_current_mesh(str(saved), preset="Sewing", page="a4", mm_per_unit=50.0)
    exported = tmp_path / "filter" / "saved.pdf"
    exported.parent.mkdir()
    flattened.apply_filter(
        "export_pattern", output_file=str(exported), preset="Sewing", page="a4", mm_per_unit=50.0
    )
    assert saved.read_bytes() == exported.read_bytes()


def test_command_line_writes_all_formats(obj: Callable, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["run", str(obj(meshes.sphere())), "-o", str(out), "--charts", "4"]
    arguments += ["--formats", "svg,pdf,dxf", "--preset", "sewing", "--page", "a4"]
    assert main([*arguments, "--seam-allowance-mm", "9", "--height-mm", "150"]) == 0
    svg = files.read_svg(out / "mesh.svg")
    cut = files.polygons(svg["cut"])
    sew = files.polygons(svg["sew"])
    for name, piece in sew.items():
        assert cut[name.replace("-sew", "-cut")].exterior.distance(piece) > 8.9
    assert "1" in files.read_dxf(out / "mesh.dxf")
    assert len(pypdf.PdfReader(out / "mesh.pdf", strict=True).pages) > 1


def test_matched_outlines_of_real_models_do_not_overlap(
    pymeshlab: Any, data: Path, tmp_path: Path
) -> None:
    # A chart of this solid touches itself, so that its outline crosses itself by rounding.
    ms = pymeshlab.MeshSet()
    ms.load_new_mesh(str(data / "public" / "syn_bracket.ply"))
    ms.compute_segmentation_dcharts_per_face(charts_number=10)
    ms.compute_texcoord_parametrization_charts_per_wedge()
    file = tmp_path / "x.svg"
    ms.export_pattern(output_file=str(file), height_mm=250.0, match_seams=True)
    rings = files.read_svg(file)["cut"].rings
    assert max(files.overlap_of_itself(ring) for ring in rings) < 0.5
    # Too rarely used for the dialog of 'Save as'.
    with pytest.raises(pymeshlab.PyMeshLabException):
        ms.save_current_mesh(str(tmp_path / "y.svg"), curve_mm=0.1)
    assert not (tmp_path / "y.svg").exists()
