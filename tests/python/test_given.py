"""Charts and seams that the user has, on the command line and in the host."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import hosts
import meshes
from devseg import host, ply
from devseg.cli import main
from devseg.given import components


def obj_with_islands(path: Path, mesh: meshes.Mesh, island: np.ndarray) -> Path:
    """An OBJ file with a flat map of each island, each at a scale of its own."""
    vertices, faces = mesh
    rows = ["v {:.17g} {:.17g} {:.17g}".format(*v) for v in vertices]
    corners = []
    for face, number in zip(faces, island, strict=True):
        words = []
        for v in face:
            x, y, z = vertices[v]
            angle = np.arctan2(z, x)
            turn = np.remainder(angle - number * np.pi / 2 + np.pi / 2, 2 * np.pi) - np.pi / 2
            corners.append(f"vt {10 * number + (1 + number) * turn:.17g} {(1 + number) * y:.17g}")
            words.append(f"{v + 1}/{len(corners)}")
        rows.append("f " + " ".join(words))
    path.write_text("\n".join([*rows[: len(vertices)], *corners, *rows[len(vertices) :]]) + "\n")
    return path


def quarters(mesh: meshes.Mesh) -> np.ndarray:
    middle = mesh[0][mesh[1]].mean(axis=1)
    return (np.arctan2(middle[:, 2], middle[:, 0]) % (2 * np.pi) // (np.pi / 2)).astype(int)


def ran(*arguments: str | Path, out: Path) -> dict[str, Any]:
    assert main(["run", *map(str, arguments), "-o", str(out), "--no-picture"]) == 0
    return json.loads((out / f"{Path(arguments[0]).stem}.json").read_text())


def saved(file: Path) -> np.ndarray:
    rows = ply._face_rows(file)
    assert rows is not None
    return rows


def same_parts(a: np.ndarray, b: np.ndarray) -> bool:
    pairs = np.unique(np.stack([a, b]), axis=1).shape[1]
    return pairs == len(np.unique(a)) == len(np.unique(b))


def test_islands_of_the_file_are_the_pieces_at_their_true_size(tmp_path: Path) -> None:
    mesh = meshes.cylinder()
    file = obj_with_islands(tmp_path / "tube.obj", mesh, quarters(mesh))
    result = ran(file, "--charts-from", "uv", out=tmp_path / "out")
    assert result["charts_from"] == "uv" and result["method"] is None
    flat = result["parametrization"]
    assert flat["charts_number"] == 4
    assert flat["l2_stretch"] == pytest.approx(1, abs=1e-6)
    assert same_parts(saved(tmp_path / "out" / "tube.ply")["chart_id"], quarters(mesh))
    svg = (tmp_path / "out" / "tube.svg").read_text()
    assert all(f"P0{i}" in svg for i in range(1, 5)) and "P05" not in svg


def islands(vertices: np.ndarray, faces: np.ndarray, uv: np.ndarray) -> int:
    """How many parts hang together by edges whose faces have the same coordinates, unfolded."""
    leader = list(range(len(faces)))

    def find(f: int) -> int:
        while leader[f] != f:
            f = leader[f]
        return f

    beside: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for f, face in enumerate(faces):
        for k in range(3):
            a, b = int(face[k]), int(face[(k + 1) % 3])
            beside.setdefault((min(a, b), max(a, b)), []).append((f, k))

    def area(f: int) -> float:
        p, q = uv[f, 1] - uv[f, 0], uv[f, 2] - uv[f, 0]
        return float(p[0] * q[1] - p[1] * q[0])

    for sides in beside.values():
        if len(sides) != 2:
            continue
        (f, i), (g, k) = sides
        whole = np.allclose(uv[f, i], uv[g, (k + 1) % 3]) and np.allclose(
            uv[f, (i + 1) % 3], uv[g, k]
        )
        if whole and area(f) * area(g) > 0:
            leader[find(f)] = find(g)
    return len({find(f) for f in range(len(faces))})


def read_obj(file: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices, triangles, and their texture coordinates (#F by 3 by 2)."""
    words = [line.split() for line in file.read_text().splitlines() if line.strip()]
    vertices = np.array([list(map(float, w[1:4])) for w in words if w[0] == "v"])
    places = np.array([list(map(float, w[1:3])) for w in words if w[0] == "vt"])
    corners = []
    for row in (w[1:] for w in words if w[0] == "f"):
        numbers = [[int(n) - 1 for n in corner.split("/")[:2]] for corner in row]
        corners += [[numbers[0], numbers[k], numbers[k + 1]] for k in range(1, len(numbers) - 1)]
    both = np.array(corners)
    return vertices, both[:, :, 0], places[both[:, :, 1]]


def built(name: str, folder: Path) -> Path:
    """An OBJ file with islands at scales of their own."""
    if name == "tube":
        mesh = meshes.cylinder()
        return obj_with_islands(folder / "tube.obj", mesh, quarters(mesh))
    if name == "ball":
        mesh = meshes.sphere()
        return obj_with_islands(folder / "ball.obj", mesh, quarters(mesh))
    vertices, faces = meshes.cube()  # each side drawn from its own corner, and larger than the last
    rows = ["v {:.17g} {:.17g} {:.17g}".format(*v) for v in vertices]
    corners, words = [], []
    for f, face in enumerate(faces):
        side = f // 2
        flat = np.delete(vertices[face], int(np.ptp(vertices[face], axis=0).argmin()), axis=1)
        words.append("f " + " ".join(f"{v + 1}/{len(corners) + k + 1}" for k, v in enumerate(face)))
        corners += [f"vt {5 * side + (1 + side) * u} {(1 + side) * v}" for u, v in flat]
    (folder / "cube.obj").write_text("\n".join([*rows, *corners, *words]) + "\n")
    return folder / "cube.obj"


@pytest.mark.parametrize(
    ("name", "number"),
    [
        ("ball_six_gores_uv_scales.obj", 6),
        ("mirrored_uv.obj", 2),
        ("tube", 4),
        ("ball", 4),
        ("cube", 6),
    ],
)
def test_pieces_are_as_many_as_islands_and_all_at_one_scale(
    name: str, number: int, data: Path, tmp_path: Path
) -> None:
    file = data / "cases" / name if name.endswith(".obj") else built(name, tmp_path)
    vertices, faces, uv = read_obj(file)
    assert islands(vertices, faces, uv) == number
    result = ran(file, "--charts-from", "uv", out=tmp_path / "out")
    flat = result["parametrization"]
    assert flat["charts_number"] == flat["disk_charts_number"] == number
    assert flat["flipped_faces_number"] == flat["overlapping_faces_number"] == 0
    rows = saved(tmp_path / "out" / f"{file.stem}.ply")
    np.testing.assert_array_equal(rows["vertex_indices"], faces)
    corners = rows["texcoord"].reshape(-1, 3, 2).astype(float)
    p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    plane = 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    surface = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chart = rows["chart_id"].astype(int)
    ratio = np.bincount(chart, plane) / np.bincount(chart, surface)
    np.testing.assert_allclose(ratio, plane.sum() / surface.sum(), rtol=1e-5)


def test_charts_of_a_file_that_was_written_are_the_pieces(tmp_path: Path) -> None:
    mesh = meshes.sphere()
    file = obj_with_islands(tmp_path / "ball.obj", mesh, quarters(mesh))
    ran(file, "--charts-from", "uv", out=tmp_path / "first")
    written = tmp_path / "first" / "ball.ply"
    result = ran(written, "--charts-from", "attribute", out=tmp_path / "second")
    assert result["charts_from"] == "attribute" and result["method"] is None
    before, after = saved(written), saved(tmp_path / "second" / "ball.ply")
    for name in ("chart_id", "seam_edges"):
        np.testing.assert_array_equal(before[name], after[name])


def test_kept_seams_stay_and_more_may_come(tmp_path: Path) -> None:
    mesh = meshes.sphere()
    file = obj_with_islands(tmp_path / "ball.obj", mesh, quarters(mesh))
    for source in ((), ("--charts-from", "uv")):
        result = ran(file, "--keep-seams", *source, "--charts", "12", out=tmp_path / "out")
        assert result["method"] == "dcharts"
        charts = saved(tmp_path / "out" / "ball.ply")["chart_id"]
        for chart in np.unique(charts):
            assert len(np.unique(quarters(mesh)[charts == chart])) == 1
    plain = meshes.write_obj(tmp_path / "plain.obj", *mesh)
    assert main(["run", str(plain), "-o", str(tmp_path / "o"), "--keep-seams"]) == 1
    assert not (tmp_path / "o").exists()


def test_numbers_of_a_file_are_charts_and_the_rest_is_segmented(tmp_path: Path) -> None:
    mesh = meshes.sphere()
    file = meshes.write_obj(tmp_path / "ball.obj", *mesh)
    numbers = tmp_path / "charts.txt"
    numbers.write_text("\n".join(str(7 * q) for q in quarters(mesh)))
    result = ran(file, "--charts-from", str(numbers), out=tmp_path / "out")
    assert result["parametrization"]["charts_number"] == 4
    assert same_parts(saved(tmp_path / "out" / "ball.ply")["chart_id"], quarters(mesh))

    some = np.where(quarters(mesh) < 2, quarters(mesh), -1)
    numbers.write_text(" ".join(map(str, some)))
    result = ran(file, "--charts-from", str(numbers), "--charts", "4", out=tmp_path / "out")
    charts = saved(tmp_path / "out" / "ball.ply")["chart_id"]
    assert result["method"] == "dcharts"
    np.testing.assert_array_equal(charts[some >= 0], some[some >= 0])
    assert len(np.unique(charts[some < 0])) > 1 and charts.min() == 0


@pytest.mark.parametrize(
    ("text", "found"), [("1 2 3", "3 words"), ("x " * 12, "whole numbers"), (None, "a file")]
)
def test_other_files_are_refused(
    text: str | None, found: str, tmp_path: Path, fails: Callable[..., str]
) -> None:
    file = meshes.write_obj(tmp_path / "cube.obj", *meshes.cube())
    numbers = tmp_path / "numbers.txt"
    if text is not None:
        numbers.write_text(text)
    error = fails("run", file, "-o", tmp_path / "out", "--charts-from", numbers)
    assert found in error
    assert not (tmp_path / "out").exists()


def test_components_and_materials(tmp_path: Path) -> None:
    two = meshes.joined(meshes.cylinder(), meshes.cube(), (5, 0, 0))
    file = meshes.write_obj(tmp_path / "two.obj", *two)
    result = ran(file, "--charts-from", "components", out=tmp_path / "out")
    assert result["parametrization"]["charts_number"] == 2
    tube = ran(file, "--component", "1", "--charts", "1", out=tmp_path / "out")
    cube = ran(file, "--component", "2", "--charts", "1", out=tmp_path / "out")
    assert (tube["mesh"]["faces"], cube["mesh"]["faces"]) == (1152, 12)

    mesh = meshes.cylinder()
    lines = meshes.write_obj(tmp_path / "tube.obj", *mesh).read_text().splitlines()
    half = len(mesh[0]) + len(mesh[1]) // 2
    lines[half:half] = ["usemtl red"]
    lines[len(mesh[0]) : len(mesh[0])] = ["usemtl blue"]
    (tmp_path / "tube.obj").write_text("\n".join(lines) + "\n")
    result = ran(tmp_path / "tube.obj", "--charts-from", "materials", out=tmp_path / "out")
    assert result["parametrization"]["charts_number"] == 2
    charts = saved(tmp_path / "out" / "tube.ply")["chart_id"]
    assert same_parts(charts, np.arange(len(mesh[1])) >= len(mesh[1]) // 2)


def test_component_beyond_their_number(tmp_path: Path, fails: Callable[..., str]) -> None:
    file = meshes.write_obj(tmp_path / "cube.obj", *meshes.cube())
    error = fails("run", file, "-o", tmp_path / "out", "--component", "2")
    assert "--component from 1 to 1" in error


def test_components_are_found_in_any_order() -> None:
    vertices, faces = meshes.joined(meshes.cube(), meshes.cylinder(), (5, 0, 0))
    shuffled = np.random.default_rng(3).permutation(len(faces))
    found = components(vertices, faces[shuffled])
    np.testing.assert_array_equal(found, (faces[shuffled].min(axis=1) < 8).astype(int))


@pytest.fixture
def tube(tmp_path: Path) -> Path:
    """A tube in four pieces, as `devseg run` writes it."""
    mesh = meshes.cylinder()
    file = obj_with_islands(tmp_path / "tube.obj", mesh, quarters(mesh))
    ran(file, "--charts-from", "uv", out=tmp_path / "four")
    return tmp_path / "four" / "tube.ply"


def edited(tube: Path, *arguments: str) -> np.ndarray:
    out = tube.parent / "edited.ply"
    assert main(["edit", str(tube), "-o", str(out), *arguments]) == 0
    return saved(out)


def test_edit_joins_splits_and_removes_by_the_numbers_of_the_pattern(tube: Path) -> None:
    before = saved(tube)["chart_id"]
    charts = edited(tube, "--join", "1,2")["chart_id"]
    assert same_parts(charts, np.where(before == 1, 0, before))
    charts = edited(tube, "--split", "4")["chart_id"]
    assert len(np.unique(charts)) == 5
    assert len(np.unique(charts[before == 3])) == 2
    for seam in "1234":
        assert len(np.unique(edited(tube, "--remove-seam", seam)["chart_id"])) == 3
    # Numbers mean the same in all steps.
    charts = edited(tube, "--join", "1,2", "--join", "3,4", "--split", "3")["chart_id"]
    assert len(np.unique(charts)) == 3
    assert len(np.unique(charts[before < 2])) == 1


def test_edited_file_is_edited_again(tube: Path) -> None:
    edited(tube, "--join", "1,2")
    again = tube.parent / "edited.ply"
    out = tube.parent / "again.ply"
    assert main(["edit", str(again), "-o", str(out), "--join", "1,2,3"]) == 0
    assert len(np.unique(saved(out)["chart_id"])) == 1


def test_edit_refuses_with_the_stretch(tmp_path: Path, fails: Callable[..., str]) -> None:
    mesh = meshes.sphere()
    file = obj_with_islands(tmp_path / "ball.obj", mesh, quarters(mesh))
    ran(file, "--charts-from", "uv", out=tmp_path / "four")
    ball = tmp_path / "four" / "ball.ply"
    out = tmp_path / "out.ply"
    error = fails("edit", ball, "-o", out, "--join", "1,2,3,4")
    assert "L2 stretch of 1." in error and "--force" in error and not out.exists()
    assert "from 1 to 4" in fails("edit", ball, "-o", out, "--join", "1,9")
    assert "--join" in fails("edit", ball, "-o", out, "--join", "1,b")
    assert main(["edit", str(ball), "-o", str(out), "--join", "1,2,3,4", "--force"]) == 0
    plain = meshes.write_obj(tmp_path / "plain.obj", *mesh)
    assert "texture coordinates" in fails("edit", plain, "-o", tmp_path / "p.ply", "--split", "1")


@pytest.mark.parametrize(
    "arguments",
    [["edit", "a.ply"], ["edit", "a.ply", "-o", "b.ply"], ["edit", "a.ply", "-o", "b.obj"]],
)
def test_wrong_usage_of_edit(arguments: list[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2


@pytest.fixture
def ball(meshset: Callable[[meshes.Mesh], Any]) -> Any:
    meshes_ = meshset(meshes.sphere())
    meshes_.compute_segmentation_dcharts_per_face(charts_number=6)
    meshes_.compute_texcoord_parametrization_charts_per_wedge()
    return meshes_


def state(mesh: Any) -> list[np.ndarray]:
    return [
        mesh.face_custom_scalar_attribute_array("chart_id"),
        mesh.wedge_tex_coord_matrix().reshape(-1, 6),
        mesh.face_color_matrix(),
        mesh.face_scalar_array(),
        mesh.face_matrix(),
    ]


def filters_on_part() -> list[str]:
    """Those that take `selected_only`."""
    return [
        str(f["python_name"])
        for f in hosts.declarations()
        if any(p["name"] == "selected_only" for p in f["parameters"])
    ]


def test_host_changes_nothing_outside_of_the_selection(ball: Any, pymeshlab: ModuleType) -> None:
    ball.compute_selection_by_condition_per_face(condselect="y0 > 0.2")
    names = filters_on_part()
    assert len(names) >= 13
    for name in names:
        selected = ball.current_mesh().face_selection_array()
        points = ball.current_mesh().vertex_matrix()
        before = state(ball.current_mesh())
        getattr(ball, name)(selected_only=True)
        after = state(ball.current_mesh())  # faces that are split leave their parts at the end
        for old, new in zip(before, after, strict=True):
            outside = new[: len(old)][~selected]
            assert old[~selected].tobytes() == outside.tobytes(), name
        now = ball.current_mesh().vertex_matrix()[: len(points)]
        assert points.tobytes() == now.tobytes(), name
        ball.compute_selection_by_condition_per_face(condselect="y0 > 0.2")
    ball.set_selection_none()
    ball.set_verbosity(True)  # a silent host goes on swallowing what is printed after a failure
    with host.captured(), pytest.raises(pymeshlab.PyMeshLabException, match="expected selected"):
        ball.compute_segmentation_dcharts_per_face(selected_only=True)
    ball.set_verbosity(False)


def test_host_reads_selected_edges_faces_and_vertices(
    meshset: Callable[[meshes.Mesh], Any],
) -> None:
    cube = meshset(meshes.cube())
    cube.compute_selection_crease_per_edge(angledegneg=-30, angledegpos=30)
    made = cube.compute_charts_from_selected_edges_per_face()
    assert made["charts_number"] == 6
    cube.compute_selection_by_condition_per_face(condselect="(chart_id == 0) || (chart_id == 2)")
    joined = cube.apply_charts_join_selected()
    assert joined["charts_number"] == 5 and joined["l2_stretch"] == pytest.approx(1)
    split = cube.apply_charts_split_selected(along_selection=False)
    assert split["charts_number"] == 6


def test_script_edits_by_the_numbers_of_the_pattern(
    meshset: Callable[[meshes.Mesh], Any], tmp_path: Path
) -> None:
    steps = (
        ("Charts: Join Selected", "apply_charts_join_selected", "pieces", "1,2"),
        ("Charts: Split Selected", "apply_charts_split_selected", "pieces", "3"),
        ("Charts: Remove Selected Seams", "apply_charts_remove_selected_seams", "seams", "9"),
    )
    rows = [
        f'<filter name="{menu}"><Param name="{name}" type="RichString" value="{numbers}"/>'
        '<Param name="force" type="RichBool" value="true"/></filter>'
        for menu, _, name, numbers in steps
    ]
    (tmp_path / "edit.mlx").write_text(f"<FilterScript>{''.join(rows)}</FilterScript>")
    charts = []
    for scripted in (True, False):
        ball = meshset(meshes.sphere())
        ball.compute_segmentation_variational_shape_approximation_per_face(charts_number=6)
        ball.compute_texcoord_parametrization_charts_per_wedge()
        before = ball.current_mesh().face_custom_scalar_attribute_array("chart_id")
        if scripted:
            ball.load_filter_script(str(tmp_path / "edit.mlx"))
            ball.apply_filter_script()
        else:
            for _, python, name, numbers in steps:
                getattr(ball, python)(**{name: numbers}, force=True)
        charts.append(ball.current_mesh().face_custom_scalar_attribute_array("chart_id"))
        assert not same_parts(before, charts[-1])
    np.testing.assert_array_equal(*charts)


def test_host_makes_smooth_seams_of_a_selection(ball: Any) -> None:
    faces = ball.current_mesh().face_number()
    ball.compute_selection_by_condition_per_face(condselect="x0 + 0.4 * y0 > 0.2")
    plain = ball.compute_charts_from_selected_edges_per_face()
    assert ball.current_mesh().face_number() == faces
    made = ball.compute_charts_from_selected_edges_per_face(smooth=True)
    mesh = ball.current_mesh()
    assert mesh.face_number() > faces
    assert made["charts_number"] == plain["charts_number"] > 1
    assert made["seam_length"] < plain["seam_length"]
    chart, color = mesh.face_custom_scalar_attribute_array("chart_id"), mesh.face_color_matrix()
    pairs = np.unique(np.column_stack([chart, color]), axis=0)
    assert len(pairs) == len(np.unique(chart)) == made["charts_number"]
    ball.compute_texcoord_parametrization_charts_per_wedge()
    flat = ball.get_parametrization_measures()
    assert flat["flipped_faces_number"] == flat["overlapping_faces_number"] == 0


def test_host_cuts_the_mesh_open_and_merging_closes_it(ball: Any) -> None:
    before = ball.current_mesh()
    vertices, faces = before.vertex_number(), before.face_number()
    charts = before.face_custom_scalar_attribute_array("chart_id")
    made = ball.meshing_cut_along_seams()
    cut = ball.current_mesh()
    assert cut.vertex_number() == vertices + made["new_vertices_number"]
    assert cut.face_number() == faces
    np.testing.assert_array_equal(cut.face_custom_scalar_attribute_array("chart_id"), charts)
    corners = cut.vertex_matrix()[cut.face_matrix()]
    # Vertices of the cut mesh have one texture coordinate each.
    uv = cut.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    places: dict[int, set[tuple[float, float]]] = {}
    for face, of_face in zip(cut.face_matrix(), uv, strict=True):
        for v, p in zip(face, of_face, strict=True):
            places.setdefault(int(v), set()).add((float(p[0]), float(p[1])))
    assert max(len(found) for found in places.values()) == 1
    ball.meshing_merge_close_vertices()
    merged = ball.current_mesh()
    assert merged.vertex_number() == vertices
    np.testing.assert_allclose(merged.vertex_matrix()[merged.face_matrix()], corners, atol=1e-9)
