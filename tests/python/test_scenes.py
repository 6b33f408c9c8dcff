"""Several objects in a file, their names, units and upward axes, and what results keep of them."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from PIL import Image

import gltf_files
import meshes
from conftest import ROOT
from devseg import scene
from devseg.cli import main
from devseg.frame import Frame, read_frame
from devseg.load import list_objects, load_mesh
from devseg.notes import ADVICE, as_option
from devseg.obj_parts import Part
from scene_files import run_json, write_3mf

pytestmark = pytest.mark.usefixtures("pymeshlab")

TWO_OBJECTS = """mtllib a.mtl
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 5
v 1 0 5
v 0 1 5
o Table top
usemtl wood
f 1 2 3 4
o Ball
g half
usemtl Grün Filz
f 5 6 7
f 5 5 6
g rest
f -3 -1 -2
"""
MATERIALS = "newmtl wood\nKd 0.5 0.25 0\nmap_Kd wood.png\nbump b.png\nnewmtl Grün Filz\nKd 0 1 0\n"


def volume(mesh: Any) -> float:
    a, b, c = np.moveaxis(mesh.vertex_matrix()[mesh.face_matrix()], 1, 0)
    return float((np.cross(a, b) * c).sum() / 6)


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A tube that is moved, in it a ball that is moved and mirrored, and a cube that is scaled."""
    document, data = gltf_files.document(meshes.cube(), meshes.sphere(), meshes.cylinder())
    cube, ball, tube = document["nodes"]
    document["scenes"][0]["nodes"] = [2, 0]
    tube.update(children=[1], translation=[10, 0, 0])
    ball.update(translation=[0, 7, 0], scale=[-1, 1, 1])
    cube.update(scale=[2, 3, 4])
    return gltf_files.write_glb(tmp_path / "tree.glb", document, data)


def test_all_objects_are_taken_each_at_its_place(tree: Path) -> None:
    loaded = load_mesh(tree)
    mesh = loaded.meshes.current_mesh()
    assert [part.object for part in loaded.parts] == ["object 2", "object 1", "object 0"]
    ids = scene.part_ids(mesh, loaded.parts)
    assert np.bincount(ids).tolist() == [1152, 1024, 12]
    points = mesh.vertex_matrix()[mesh.face_matrix()]
    for part, (low, high) in enumerate(
        [((9, 0, -1), (11, 3, 1)), ((9, 6, -1), (11, 8, 1)), ((0, 0, 0), (2, 3, 4))]
    ):
        corners = points[ids == part].reshape(-1, 3)
        assert corners.min(axis=0) == pytest.approx(low, abs=0.01)
        assert corners.max(axis=0) == pytest.approx(high, abs=0.01)


def test_a_mirrored_object_is_not_turned_inside_out(tree: Path) -> None:
    mesh = load_mesh(tree, ["object 1"]).meshes.current_mesh()
    assert mesh.face_number() == 1024 and volume(mesh) > 3
    mesh = load_mesh(tree, ["object 0"]).meshes.current_mesh()
    assert volume(mesh) == pytest.approx(24)


def test_objects_are_listed_and_chosen(
    tree: Path, capfd: pytest.CaptureFixture[str], tmp_path: Path, fails: Callable[..., str]
) -> None:
    assert main(["run", str(tree), "--list-objects"]) == 0
    listed = capfd.readouterr().out
    assert listed == "object 2\t1152 faces\nobject 1\t1024 faces\nobject 0\t12 faces\n"
    assert main(["run", str(tree), "--list-objects", "--json"]) == 0
    assert json.loads(capfd.readouterr().out)[str(tree)]["object 0"] == 12
    out = ["-o", str(tmp_path / "out"), "--json", "--formats", "svg", "--longest-mm", "90"]
    chosen = ["--object", "object 0", "--object", "object 2", "--seams", "edges"]
    assert main(["run", str(tree), *out, *chosen]) == 0
    result = json.loads(capfd.readouterr().out)
    assert [(part["object"], part["faces"]) for part in result["parts"]] == [
        ("object 2", 1152),
        ("object 0", 12),
    ]
    assert max(result["size_mm"]) == pytest.approx(90)
    error = fails("run", tree, *out[:2], "--object", "cube")
    assert "('object 2', 'object 1', 'object 0'), found 'cube'" in error


def test_parts_of_an_obj_file_are_followed(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(TWO_OBJECTS, encoding="utf-8")
    loaded = load_mesh(path)
    assert loaded.parts == [
        Part("Table top", "", "wood"),
        Part("Ball", "half", "Grün Filz"),
        Part("Ball", "rest", "Grün Filz"),
    ]
    # One face repeats a vertex: the host leaves it out.
    ids = scene.part_ids(loaded.meshes.current_mesh(), loaded.parts)
    assert ids.tolist() == [0, 0, 1, 2]
    assert list_objects(path) == {"Table top": 2, "Ball": 2}
    ball = load_mesh(path, ["Ball"])
    assert ball.meshes.current_mesh().vertex_matrix()[:, 2].tolist() == [5, 5, 5]
    assert [part.group for part in ball.parts] == ["half", "rest"]


def textured_obj(folder: Path) -> Path:
    vertices, faces = meshes.cube()
    path = meshes.write_obj(folder / "a.obj", 50 * vertices, faces)
    lines = path.read_text().splitlines()
    named = ["mtllib a.mtl", "vt 0 0", "vt 0.5 0", "vt 0 0.5", *lines[:8]]
    for i, line in enumerate(lines[8:]):
        named += {0: ["o Lid", "usemtl wood"], 4: ["usemtl Grün Filz"], 8: ["o Box"]}.get(i, [])
        a, b, c = line.split()[1:]
        named.append(f"f {a}/1 {b}/2 {c}/3")
    path.write_text("\n".join(named) + "\n", encoding="utf-8")
    (folder / "a.mtl").write_text(MATERIALS, encoding="utf-8")
    Image.new("RGB", (4, 4)).save(folder / "wood.png")
    return path


def test_obj_keeps_names_and_no_stale_texture(tmp_path: Path) -> None:
    path, out = textured_obj(tmp_path), tmp_path / "out"
    result = run_json(path, "-o", out, "--formats", "obj,ply")
    replaced = [w for w in result["warnings"] if "texture coordinates" in w]
    assert len(replaced) == 1 and "wood.png" in replaced[0]
    text = (out / "a.obj").read_text(encoding="utf-8")
    names = re.findall(r"^(?:o|g|usemtl) .*$", text, re.MULTILINE)
    assert names == ["o Lid", "usemtl wood", "usemtl Grün Filz", "o Box"]
    assert "vn" not in text and text.count("\nf ") == 12
    library = (out / "a.obj.mtl").read_text(encoding="utf-8")
    assert "newmtl wood\nKd 0.5 0.25 0\n" in library and "newmtl Grün Filz\nKd 0 1 0" in library
    assert ".png" not in library
    header = (out / "a.ply").read_bytes().partition(b"end_header")[0].decode()
    assert "comment part_id 1: object Lid, material Grün Filz\n" in header
    assert "TextureFile" not in header and "texnumber" not in header
    # What is written can be read again, with the new coordinates.
    written = load_mesh(out / "a.obj")
    assert [p.material for p in written.parts] == ["wood", "Grün Filz", "Grün Filz"]
    again = load_mesh(out / "a.ply").meshes.current_mesh()
    coordinates = written.meshes.current_mesh().wedge_tex_coord_matrix()
    assert again.wedge_tex_coord_matrix() == pytest.approx(coordinates, abs=1e-6)
    assert (again.face_matrix() == written.meshes.current_mesh().face_matrix()).all()


def test_materials_of_gltf_reach_obj(tmp_path: Path) -> None:
    document, data = gltf_files.document(meshes.cube(), meshes.cylinder())
    document["materials"] = [
        {"name": "red felt", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0.25, 1]}},
        {},
    ]
    cube, tube = (mesh["primitives"] for mesh in document["meshes"])
    tube[0]["material"] = 1
    cube[0]["material"] = 0
    tube.append({**cube[0]})  # a tube with a red cube in one object
    path = gltf_files.write_glb(tmp_path / "a.glb", document, data)
    out = tmp_path / "out"
    result = run_json(path, "-o", out, "--formats", "obj", "--longest-mm", 90)
    assert [tuple(part.values()) for part in result["parts"]] == [
        ("object 0", "", "red felt", 12),
        ("object 1", "", "material 1", 1152),
        ("object 1", "", "red felt", 12),
    ]
    assert "newmtl red felt\nKd 1 0 0.25\n" in (out / "a.obj.mtl").read_text()
    assert (out / "a.obj").read_text().count("usemtl ") == 3


def test_ply_keeps_the_old_coordinates_if_asked(tmp_path: Path, pymeshlab: ModuleType) -> None:
    path, out = textured_obj(tmp_path), tmp_path / "out"
    result = run_json(path, "-o", out, "--keep-texcoords")
    assert any("PLY has them as texcoord_before" in w for w in result["warnings"])
    header, _, data = (out / "a.ply").read_bytes().partition(b"end_header\n")
    assert header.endswith(b"property list uchar float texcoord_before\n")
    row = np.dtype([("rest", "V25"), ("t", "<f4", 6)])
    last = np.frombuffer(data[-25:], "u1")[0], np.frombuffer(data[-24:], "<f4")
    assert last[0] == 6 and last[1] == pytest.approx([0, 0, 0.5, 0, 0, 0.5])
    assert row.itemsize == 49
    # Other readers pass over them.
    meshset = pymeshlab.MeshSet()
    meshset.load_new_mesh(str(out / "a.ply"))
    assert meshset.current_mesh().face_number() == 12


def test_ply_files_of_ours_keep_their_parts(tmp_path: Path) -> None:
    result = run_json(textured_obj(tmp_path), "-o", tmp_path / "one", "--seams", "edges")
    again = run_json(tmp_path / "one" / "a.ply", "-o", tmp_path / "two", "--formats", "obj")
    assert again["parts"] == result["parts"]
    text = (tmp_path / "two" / "a.obj").read_text(encoding="utf-8")
    assert re.findall(r"^(?:o|usemtl) .*$", text, re.MULTILINE) == [
        "o Lid", "usemtl wood", "usemtl Grün Filz", "o Box",
    ]  # fmt: skip


def test_vertex_colors_reach_obj_and_ply(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    lines = ["v {} {} {} 1 {} 0".format(*(90 * v), v[0]) for v in vertices]
    lines += ["f {} {} {}".format(*(f + 1)) for f in faces]
    path = tmp_path / "c.obj"
    path.write_text("\n".join(lines) + "\n")
    result = run_json(path, "-o", tmp_path / "out", "--formats", "obj,ply")
    assert result["warnings"] == []
    for extension in ("obj", "ply"):
        mesh = load_mesh(tmp_path / "out" / f"c.{extension}").meshes.current_mesh()
        colors = mesh.vertex_color_matrix()
        assert colors[:, 1] == pytest.approx(vertices[:, 0], abs=0.01)


def test_parts_survive_simplification(tmp_path: Path) -> None:
    (first, faces), (second, _) = meshes.sphere(), meshes.sphere()
    lines = ["v {} {} {}".format(*v) for v in 90 * np.vstack([first, second + np.eye(3)[0] * 3])]
    for name, shift in (("left", 1), ("right", 1 + len(first))):
        lines += [f"o {name}", *("f {} {} {}".format(*(f + shift)) for f in faces)]
    path = tmp_path / "balls.obj"
    path.write_text("\n".join(lines) + "\n")
    result = run_json(path, "-o", tmp_path / "out", "--target-faces", 600, "--seams", "edges")
    assert [part["object"] for part in result["parts"]] == ["left", "right"]
    assert [part["faces"] for part in result["parts"]] == pytest.approx([300, 300], abs=30)


def test_frames_of_formats(tmp_path: Path) -> None:
    for unit, mm in ((' unit="inch"', 25.4), ("", 1.0), (" unit='meter'", 1000.0)):
        assert read_frame(write_3mf(tmp_path / "a.3mf", unit)) == Frame(mm, "z")
    collada = tmp_path / "a.dae"
    collada.write_text('<asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>')
    assert read_frame(collada) == Frame(pytest.approx(25.4), "z")
    collada.write_text("<asset></asset>")
    assert read_frame(collada) == Frame(1000.0, "y")
    assert read_frame(tmp_path / "a.glb") == Frame(1000.0, "y")
    assert read_frame(tmp_path / "a.stl") == Frame(None, None)


@pytest.mark.parametrize(
    ("options", "size"),
    [
        (["--height-mm", "250", "--up", "z"], (100, 100, 250)),
        (["--height", "10in", "--up", "z"], (101.6, 101.6, 254)),
        (["--height-mm", "40", "--up", "y"], (40, 40, 100)),
        (["--longest", "25cm"], (100, 100, 250)),
        (["--mm-per-unit", "2"], (80, 80, 200)),
        ([], (40, 40, 100)),
    ],
)
def test_sizes_of_a_vase(
    options: list[str], size: tuple[float, ...], obj: Callable, tmp_path: Path
) -> None:
    vertices, faces = meshes.cylinder(20, 100)
    path = obj((vertices[:, [0, 2, 1]] * (1, -1, 1), faces))
    result = run_json(path, "-o", tmp_path / "out", *options)
    assert result["size_mm"] == pytest.approx(size, rel=0.01)
    assert result["warnings"] == []
    written = load_mesh(tmp_path / "out" / "mesh.ply").meshes.current_mesh()
    # Whatever is up, the mesh stays as it was.
    assert (written.vertex_matrix() == load_mesh(path).meshes.current_mesh().vertex_matrix()).all()
    svg = (tmp_path / "out" / "mesh.svg").read_text()
    height = max(map(float, re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg).groups()))
    assert height >= max(size)


def test_surprising_sizes_are_told(obj: Callable, tmp_path: Path) -> None:
    vertices, faces = meshes.cylinder(20, 100)
    lying = obj((vertices[:, [0, 2, 1]] * (1, -1, 1), faces), "lying")
    warnings = run_json(lying, "-o", tmp_path / "out", "--height-mm", 250)["warnings"]
    assert len(warnings) == 1 and "40 of 100 units" in warnings[0] and "--up z" in warnings[0]
    for factor, words in ((0.001, "0.04 x 0.1 x 0.04 mm"), (100, "4,000 x 10,000 x 4,000 mm")):
        path = obj((factor * vertices, faces), "tube")
        told = run_json(path, "-o", tmp_path / "out")["warnings"]
        assert any(words in w and "--longest-mm" in w for w in told)
        quiet = run_json(path, "-o", tmp_path / "out", "--mm-per-unit", 1)["warnings"]
        assert not any(words in w for w in quiet)


def test_gltf_is_in_metres(tree: Path, tmp_path: Path) -> None:
    result = run_json(tree, "-o", tmp_path / "out", "--object", "object 0")
    assert result["size_mm"] == pytest.approx([2000, 3000, 4000])
    result = run_json(tree, "-o", tmp_path / "out", "--object", "object 0", "--height", "1m")
    assert result["size_mm"] == pytest.approx([2000 / 3, 1000, 4000 / 3])


def test_a_small_mesh_with_a_double_face_runs(obj: Callable, tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    few = faces[:7]
    path = obj((90 * vertices, np.vstack([few, few[:1]])))
    result = run_json(path, "-o", tmp_path / "out")
    assert any("lies on the vertices of another" in w for w in result["warnings"])
    assert 1 <= result["parametrization"]["charts_number"] <= 7


def test_a_solid_that_is_inside_out_is_turned(obj: Callable, tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    told = {}
    for name, these in (("out", faces), ("in", faces[:, ::-1]), ("open", faces[1:, ::-1])):
        # As STL files have it: each face with vertices of its own.
        separate = 90 * vertices[these].reshape(-1, 3), np.arange(3 * len(these)).reshape(-1, 3)
        loaded = load_mesh(obj(separate, name))
        told[name] = loaded.warnings
        assert (volume(loaded.meshes.current_mesh()) > 0) == (name != "open")
    assert told["out"] == told["open"] == []
    assert told["in"] == ["the solid is inside out: its faces looked inwards and were turned"]


def test_notes_of_the_export_are_warnings(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.cube())
    warnings = run_json(path, "-o", tmp_path / "out", "--longest-mm", "1")["warnings"]
    assert any("no room for a name" in warning for warning in warnings)


def test_errors_name_options(obj: Callable, tmp_path: Path, fails: Callable[..., str]) -> None:
    path = obj((90 * meshes.cube()[0], meshes.cube()[1]))
    error = fails("run", path, "-o", tmp_path / "out", "--fold-angle", "999")
    assert ": --fold-angle: expected" in error
    error = fails("run", path, "-o", tmp_path / "out", "--page", "a4", "--page-margin-mm", "100")
    assert ": --page-margin-mm: expected margins" in error


def test_errors_advise_what_the_command_line_has() -> None:
    sources = [*(ROOT / "filter_devseg").rglob("*.cpp"), *(ROOT / "io_pattern").rglob("*.cpp")]
    text = re.sub(r'"\s*\n\s*"', "", "".join(source.read_text() for source in sources))
    for advice, ours in ADVICE:
        assert advice in text  # what filters say still
        assert as_option(f"expected a, found b; {advice}") == f"expected a, found b; {ours}"


def test_advice_for_windows_is_left_out(obj: Callable, tmp_path: Path) -> None:
    vertices, faces = meshes.three_fins()
    warnings = run_json(obj((90 * vertices, faces)), "-o", tmp_path / "out")["warnings"]
    assert any("more than two faces" in warning for warning in warnings)
    assert not any("Repair" in warning for warning in warnings)


def test_vertices_at_the_same_place_are_joined_or_left(obj: Callable, tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    apart = (90 * vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3))
    path = obj(apart)
    for how, charts in (("on", 1), ("0.001", 1), ("off", len(faces))):
        result = run_json(path, "-o", tmp_path / how, "--weld", how, "--no-picture")
        assert result["parametrization"]["charts_number"] == charts, how
        joined = any("were joined" in warning for warning in result["warnings"])
        assert joined == (how != "off")
    with pytest.raises(SystemExit):
        main(["run", str(path), "-o", str(tmp_path / "none"), "--weld", "no"])
