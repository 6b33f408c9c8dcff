"""Names, materials and triangles of 3MF, STL and Collada files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import meshes
from devseg import three_ds
from devseg.load import list_objects, load_mesh
from devseg.obj_parts import Part
from scene_files import (
    geometry,
    object_3ds,
    primitives,
    run_json,
    text_stl,
    write_3ds,
    write_3mf,
    write_dae,
)

pytestmark = pytest.mark.usefixtures("pymeshlab")


def test_objects_of_3mf(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    rows = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*v) for v in vertices)
    cells = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*f) for f in faces)
    mesh = f"<mesh><vertices>{rows}</vertices><triangles>{cells}</triangles></mesh>"
    content = (
        f'<resources><object id="1" name="Lid" type="model">{mesh}</object>'
        f'<object id="2" type="model">{mesh}</object><object id="3" name="Set" type="model">'
        '<components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 0 5 0"/>'
        '<component objectid="2" transform="1 0 0 0 1 0 0 0 1 0 0 9"/></components></object>'
        '</resources><build><item objectid="2" transform="2 0 0 0 2 0 0 0 3 10 0 0"/>'
        '<item objectid="3"/></build>'
    )
    path = write_3mf(tmp_path / "a.3mf", ' unit="inch"', content)
    assert list_objects(path) == {"object 0": 12, "Set": 24}
    result = run_json(path, "-o", tmp_path / "out", "--object", "object 0")
    assert result["size_mm"] == pytest.approx([50.8, 50.8, 76.2])
    points = load_mesh(path, ["Set"]).meshes.current_mesh().vertex_matrix()
    assert points.max(axis=0).tolist() == [1, 6, 10]


def test_materials_of_3mf(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    rows = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*(90 * v)) for v in vertices)
    cells = [
        '<triangle v1="{}" v2="{}" v3="{}"{}/>'.format(*f, ' pid="9" p1="0"' if i < 4 else "")
        for i, f in enumerate(faces)
    ]
    mesh = f"<mesh><vertices>{rows}</vertices><triangles>{''.join(cells)}</triangles></mesh>"
    content = (
        '<resources><basematerials id="9"><base name="Red felt" displaycolor="#FF0000FF"/>'
        '<base name="Blue" displaycolor="#000080"/></basematerials>'
        f'<object id="1" name="Lid" type="model" pid="9" pindex="1">{mesh}</object></resources>'
        '<build><item objectid="1"/></build>'
    )
    path = write_3mf(tmp_path / "a.3mf", "", content)
    result = run_json(path, "-o", tmp_path / "out", "--formats", "obj")
    assert [tuple(part.values()) for part in result["parts"]] == [
        ("Lid", "", "Red felt", 4),
        ("Lid", "", "Blue", 8),
    ]
    library = (tmp_path / "out" / "a.obj.mtl").read_text()
    assert library.startswith("newmtl Red felt\nKd 1 0 0\n") and "Kd 0 0 0.501961" in library


def test_triangles_of_3mf_that_name_a_corner_twice_are_left_out(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    rows = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*(90 * v)) for v in vertices)
    repeated = [(0, 0, 1), (0, 1, 1), (1, 0, 1)]
    cells = [
        '<triangle v1="{}" v2="{}" v3="{}"/>'.format(*f)
        for f in [*faces[:4], *repeated, *faces[4:]]
    ]
    content = (
        f'<resources><object id="1" type="model"><mesh><vertices>{rows}</vertices>'
        f"<triangles>{''.join(cells)}</triangles></mesh></object></resources>"
        '<build><item objectid="1"/></build>'
    )
    loaded = load_mesh(write_3mf(tmp_path / "a.3mf", "", content))
    assert loaded.meshes.current_mesh().face_number() == len(faces)
    assert loaded.warnings == ["3 triangles name a corner twice and were left out"]


def test_all_solids_of_a_text_are_read_with_their_names(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    path = tmp_path / "a.stl"
    cube, tube = (90 * vertices, faces), meshes.cylinder(20, 100)
    double = cube[0], np.vstack([faces, [[0, 0, 1]]])  # one triangle repeats a vertex
    path.write_text(text_stl("Lid one", double) + text_stl("", tube).upper())
    loaded = load_mesh(path)
    assert list_objects(path) == {"Lid one": 12, "object 1": len(tube[1])}
    corners = loaded.meshes.current_mesh().vertex_matrix()[
        loaded.meshes.current_mesh().face_matrix()
    ]
    expected = np.concatenate([cube[0][faces], tube[0][tube[1]]])
    assert corners == pytest.approx(expected, abs=1e-3)
    assert [part.object for part in load_mesh(path, ["Lid one"]).parts] == ["Lid one"]


def test_binary_stl_may_begin_with_the_word_solid(tmp_path: Path) -> None:
    row = np.zeros(1, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("", "<u2")])
    row["corners"] = np.eye(3)
    path = tmp_path / "a.stl"
    path.write_bytes(b"solid ball".ljust(80) + (1).to_bytes(4, "little") + row.tobytes())
    assert load_mesh(path).meshes.current_mesh().face_number() == 1


def test_names_and_materials_of_collada(tmp_path: Path) -> None:
    (vertices, faces), tube = meshes.cube(), meshes.cylinder()
    cube = 90 * vertices, faces
    geometries = geometry(
        "A", cube, primitives("triangles", "A", faces[:8], "x")
        + primitives("triangles", "A", faces[8:], "y"),
    ) + geometry("B", tube, primitives("triangles", "B", tube[1], "z"))  # fmt: skip
    bound = (
        "<bind_material><technique_common>"
        '<instance_material symbol="y" target="#m"/></technique_common></bind_material>'
    )
    nodes = (
        '<node name="Lid"><node name="Tube"><translate>200 0 0</translate>'
        '<instance_geometry url="#B"/></node>'
        f'<instance_geometry url="#A">{bound}</instance_geometry></node>'
    )
    path = write_dae(tmp_path / "a.dae", geometries, nodes)
    result = run_json(path, "-o", tmp_path / "out", "--formats", "obj")
    assert [tuple(part.values()) for part in result["parts"]] == [
        ("Lid", "", "x", 8),
        ("Lid", "", "Red felt", 4),
        ("Tube", "", "z", len(tube[1])),
    ]
    assert "newmtl Red felt\nKd 1 0 0.5\n" in (tmp_path / "out" / "a.obj.mtl").read_text()
    corners = load_mesh(path, ["Tube"]).meshes.current_mesh().vertex_matrix()
    assert corners[:, 0].min() == pytest.approx(199)


@pytest.mark.parametrize(("kind", "faces"), [
    ("tristrips", [[0, 1, 2], [1, 3, 2], [2, 3, 4]]),
    ("trifans", [[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
    ("polygons", [[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
])  # fmt: skip
def test_strips_fans_and_polygons_of_collada_are_read(
    kind: str, faces: list[list[int]], tmp_path: Path
) -> None:
    points = np.random.default_rng(1).random((5, 3))
    row = primitives(kind, "A", np.array([[0, 1, 2, 3, 4]]), "x")
    lines = primitives("lines", "A", np.array([[0, 1]]), "x")
    path = write_dae(
        tmp_path / "a.dae",
        geometry("A", (points, None), row + lines),
        '<node name="Sheet"><instance_geometry url="#A"/></node>',
    )
    loaded = load_mesh(path)
    mesh = loaded.meshes.current_mesh()
    assert mesh.vertex_matrix()[mesh.face_matrix()] == pytest.approx(points[faces], abs=1e-5)
    assert loaded.parts == [Part("Sheet", "", "x")]
    assert loaded.warnings == ["lines of the file were left out"]


def test_materials_of_3ds(tmp_path: Path) -> None:
    (vertices, faces), tube = meshes.cube(), meshes.cylinder()
    cube = 90 * vertices, faces
    path = write_3ds(
        tmp_path / "a.3ds",
        {"Red felt": (255, 0, 0), "Blue": (0, 0, 128)},
        object_3ds("Lid", cube, {"Red felt": [0, 1, 6, 7], "Blue": [2, 3, 4, 5]}),
        object_3ds("Tube", tube, {"Blue": list(range(len(tube[1])))}),
    )
    result = run_json(path, "-o", tmp_path / "out", "--formats", "obj")
    assert [tuple(part.values()) for part in result["parts"]] == [
        ("Lid", "", "Red felt", 4),
        ("Lid", "", "Blue", 4),
        ("Lid", "", "", 4),
        ("Tube", "", "Blue", len(tube[1])),
    ]
    library = (tmp_path / "out" / "a.obj.mtl").read_text()
    assert "newmtl Red felt\nKd 1 0 0\n" in library and "Kd 0 0 0.501961" in library


def test_a_3ds_file_that_is_cut_off_has_no_materials(tmp_path: Path) -> None:
    vertices, faces = meshes.cube()
    data = write_3ds(
        tmp_path / "a.3ds", {}, object_3ds("Lid", (vertices, faces), {"Blue": [0, 1, 2]})
    ).read_bytes()
    path = tmp_path / "b.3ds"
    for end in range(len(data)):
        path.write_bytes(data[:end])
        assert three_ds.objects(path) == [] and three_ds.material_colors(path) == {}
