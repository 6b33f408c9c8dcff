"""MeshLab's batch server: shipped scripts, patterns, failures, and that it knows every filter."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import hosts
import meshes
import reference
from conftest import ROOT

SCRIPTS = sorted((ROOT / reference.MLX).glob("*.mlx"))
FLAVOUR = "meshlab-2020.09"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> hosts.PrivateMeshLab:
    return hosts.PrivateMeshLab.make(tmp_path_factory.mktemp("server"), FLAVOUR)


@pytest.fixture(scope="module")
def bone(pymeshlab: ModuleType) -> Path:
    """A mesh whose coordinates are 32 bit in every host."""
    return Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / "bone.ply"


@pytest.fixture
def ply(meshset: Callable[[meshes.Mesh], Any], tmp_path: Path) -> Callable[[meshes.Mesh], Path]:
    def write(mesh: meshes.Mesh) -> Path:
        file = tmp_path / "input.ply"
        meshset(mesh).save_current_mesh(str(file))
        return file

    return write


def mlx(file: Path, steps: list[dict[str, Any]], **values: str) -> Path:
    """A script of these filters; values replace defaults."""
    changed = [
        {
            **step,
            "parameters": [
                {**p, "default": values.get(p["name"], p["default"])} for p in step["parameters"]
            ],
        }
        for step in steps
    ]
    file.write_text(reference.mlx_script(changed))
    return file


def sides(uv: np.ndarray) -> np.ndarray:
    """Lengths of the sides of the faces in the plane, over the root of the sum of their squares."""
    corners = uv.reshape(-1, 3, 2)
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    return lengths / np.linalg.norm(lengths)


@pytest.mark.parametrize("script", SCRIPTS, ids=[script.stem for script in SCRIPTS])
def test_shipped_script_gives_the_charts_of_pymeshlab(
    script: Path, server: hosts.PrivateMeshLab, bone: Path, pymeshlab: ModuleType, tmp_path: Path
) -> None:
    saved = [tmp_path / "server.ply", tmp_path / "pymeshlab.ply"]
    done = server.serve("-i", bone, "-o", saved[0], "-m", "fc", "fq", "wt", "-s", script)
    assert done.returncode == 0 and "Problem with filter" not in done.stdout, done.stdout
    meshset = pymeshlab.MeshSet()
    meshset.load_new_mesh(str(bone))
    meshset.load_filter_script(str(script))
    meshset.apply_filter_script()
    meshset.save_current_mesh(str(saved[1]))

    found = []
    for file in saved:
        meshset.load_new_mesh(str(file))
        mesh = meshset.current_mesh()
        found.append((mesh.face_color_matrix(), mesh.wedge_tex_coord_matrix()))
    (server_colors, server_uv), (colors, uv) = found
    assert len(np.unique(colors, axis=0)) > 3
    np.testing.assert_array_equal(server_colors, colors)
    if script.stem == "papercraft":
        # It moves vertices, which hosts round in their own ways, and the search for a layout goes
        # another way then: pieces are the same, their places need not be.
        server_uv, uv = sides(server_uv), sides(uv)
    np.testing.assert_allclose(server_uv, uv, rtol=0, atol=1e-6)


def test_pattern_is_written_as_pymeshlab_writes_it(
    server: hosts.PrivateMeshLab, bone: Path, pymeshlab: ModuleType, tmp_path: Path
) -> None:
    script = ROOT / reference.MLX / "dcharts.mlx"
    done = server.serve("-i", bone, "-o", tmp_path / "server.svg", "-s", script)
    assert done.returncode == 0, done.stdout
    meshset = pymeshlab.MeshSet()
    meshset.load_new_mesh(str(bone))
    meshset.load_filter_script(str(script))
    meshset.apply_filter_script()
    meshset.save_current_mesh(str(tmp_path / "pymeshlab.svg"))
    assert (tmp_path / "server.svg").read_text() == (tmp_path / "pymeshlab.svg").read_text()
    hosts.record("meshlabserver-2020.09", "Saving as SVG", "runs")


def test_every_filter_runs(server: hosts.PrivateMeshLab, bone: Path, tmp_path: Path) -> None:
    reported = hosts.server_report(server)
    for number, filter_ in enumerate(hosts.declarations()):
        name = filter_["menu_name"]
        assert reported[name]["help"] == filter_["help"], name
        kinds = {kind: rich.removeprefix("Rich") for kind, rich in reference.RICH_TYPES.items()}
        kinds["output file"] = "FileName"
        assert reported[name]["parameters"] == [
            {"kind": kinds[p["kind"]], "label": p["label"], "help": p["help"]}
            for p in filter_["parameters"]
        ], name
        # It aborts on scripts that do not name exactly the parameters that it knows.
        steps = hosts.with_values(hosts.prepared(filter_), tmp_path / f"{number}.svg", bone)
        mesh = hosts.sample(filter_, bone, tmp_path)
        done = server.serve("-i", mesh, "-s", mlx(tmp_path / f"{number}.mlx", steps))
        assert done.returncode == 0 and "Problem with filter" not in done.stdout, done.stdout
        for result in filter_["results"]:
            assert f"{result['name']}: " in done.stdout, name
        hosts.record("meshlabserver-2020.09", name, "as declared, runs")


def test_refused_parameters_end_with_our_message(
    server: hosts.PrivateMeshLab, bone: Path, tmp_path: Path
) -> None:
    steps = [f for f in hosts.declarations() if f["menu_name"] == "Segmentation: D-Charts"]
    script = mlx(tmp_path / "bad.mlx", steps, charts_number="-1")
    done = server.serve("-i", bone, "-o", tmp_path / "out.ply", "-s", script)
    assert done.returncode != 0
    assert "error: charts_number: expected " in done.stdout
    assert not (tmp_path / "out.ply").exists()


def test_refused_mesh_ends_with_our_message(server: hosts.PrivateMeshLab, tmp_path: Path) -> None:
    empty = tmp_path / "points.ply"
    empty.write_text(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n0 0 0\n"
    )
    done = server.serve("-i", empty, "-s", ROOT / reference.MLX / "dcharts.mlx")
    assert done.returncode != 0
    assert "error: expected " in done.stdout


def test_pattern_of_a_mesh_without_texture_coordinates_says_why(
    server: hosts.PrivateMeshLab, ply: Callable, tmp_path: Path
) -> None:
    done = server.serve("-i", ply(meshes.cube()), "-o", tmp_path / "out.svg")
    assert "devseg: error: expected wedge texture coordinates, found none" in done.stdout
    assert "out.svg has NOT been saved" in done.stdout
    assert not (tmp_path / "out.svg").exists()
    # The server itself ends with 0 when saving fails: docs/hosts.md says so.
    assert done.returncode == 0
