"""The plugins in pymeshlab: loading, names, parameters and what the filters leave on a mesh."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import devseg
import meshes

DCHARTS = "compute_segmentation_dcharts_per_face"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"
PACK = "apply_texcoord_chart_packing_per_wedge"
CUT = "compute_seams_charts_to_disks_per_edge"
COLOR = "compute_color_by_chart_per_face"

# A promise to scripts: names and defaults never change.
PARAMETERS: dict[str, dict[str, Any]] = {
    DCHARTS: {
        "charts_number": 10,
        "max_fitting_error": 0.2,
        "alpha": 1.0,
        "beta": 0.7,
        "gamma": 0.5,
        "random_seed": 0,
    },
    FLATTEN: {"pack": True},
    PACK: {"padding": 0.002, "allow_rotation": True},
    CUT: {},
    COLOR: {},
    "get_segmentation_measures": {},
    "get_parametrization_measures": {},
}


def in_new_python(code: str, *words: str) -> str:
    """Output of a script in a process of its own."""
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_loading_twice_is_harmless() -> None:
    code = """
import devseg
first = devseg.load_plugins()
assert devseg.load_plugins() == first
print(*first)
"""
    assert set(in_new_python(code).split()) >= set(PARAMETERS)


def test_loading_after_the_user_did_is_harmless() -> None:
    code = """
import pymeshlab, devseg
for path in devseg.plugin_paths():
    pymeshlab.load_plugin(str(path))
names = devseg.load_plugins()
assert len(pymeshlab.filter_list()) == len(set(pymeshlab.filter_list()))
assert all(hasattr(pymeshlab.MeshSet, name) for name in names)
print(*names)
"""
    assert set(in_new_python(code).split()) >= set(PARAMETERS)


def test_a_process_of_ours_has_all_that_devseg_uses_of_the_host() -> None:
    """Its other plugins are left out: which of its filters do our sources name?"""
    code = """
import devseg, sys
from devseg import host
if sys.argv[1:]:
    host.own_process()
names = devseg.load_plugins()
meshes = host.pymeshlab().MeshSet
if sys.argv[1:]:
    before = host.pymeshlab().plugin_number()
    one = meshes()
    one.add_mesh(host.pymeshlab().Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    one.meshing_invert_face_orientation(forceflip=True)
    assert host.pymeshlab().plugin_number() == before + 1 < 10
print(*(n for n in dir(meshes) if n not in names))
"""
    every = set(in_new_python(code).split())
    ours = set(in_new_python(code, "own").split())
    sources = Path(devseg.__file__).parent.glob("*.py")
    words = {word for file in sources for word in re.findall(r"\b[a-z_]{8,}\b", file.read_text())}
    used = words & every
    assert used <= ours < every and len(used) > 10


def test_plain_pymeshlab_works() -> None:
    code = """
import pymeshlab, devseg
pymeshlab.load_plugin(str(devseg.plugin_paths()[0]))
ms = pymeshlab.MeshSet()
ms.create_sphere(subdiv=3)
ms.apply_filter("compute_segmentation_dcharts_per_face", charts_number=4)
print(ms.current_mesh().face_custom_scalar_attribute_array("chart_id").max())
"""
    assert float(in_new_python(code).splitlines()[-1]) >= 1


@pytest.mark.parametrize("name", PARAMETERS)
def test_parameters_and_defaults(name: str, meshset: Callable) -> None:
    values = meshset(meshes.sphere()).filter_parameter_values(name)
    for parameter, default in PARAMETERS[name].items():
        # The host keeps real numbers in 32 bits.
        assert values[parameter] == pytest.approx(default, rel=1e-6), parameter


@pytest.mark.parametrize("method", ["Symmetric Dirichlet", "LSCM"])
def test_flattening_methods_are_named(method: str, meshset: Callable) -> None:
    ms = meshset(meshes.cylinder())
    ms.apply_filter(DCHARTS, charts_number=3)
    ms.apply_filter(CUT)
    ms.apply_filter(FLATTEN, method=method)
    assert ms.get_parametrization_measures()["flipped_faces_number"] == 0


@pytest.fixture
def segmented(meshset: Callable) -> Any:
    """A sphere with charts, cut to disks."""
    ms = meshset(meshes.sphere())
    ms.compute_segmentation_dcharts_per_face(charts_number=6)
    ms.compute_seams_charts_to_disks_per_edge()
    return ms


def edges_of(faces: np.ndarray) -> np.ndarray:
    """Pairs of half-edges 3 f + e on the same edge, #E by 2."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    key = ends[:, 0] * (faces.max() + 1) + ends[:, 1]
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    return np.stack([order[same], order[same + 1]], axis=1)


def test_charts_are_contiguous_and_connected(segmented: Any) -> None:
    mesh = segmented.current_mesh()
    charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    assert sorted(set(charts)) == list(range(charts.max() + 1))
    pairs = edges_of(mesh.face_matrix()) // 3
    inside = pairs[charts[pairs[:, 0]] == charts[pairs[:, 1]]]
    label = np.arange(len(charts))
    for _ in range(len(charts)):
        before = label.copy()
        for a, b in (inside.T, inside.T[::-1]):
            np.minimum.at(label, a, label[b])
        if (label == before).all():
            break
    assert len(set(label)) == charts.max() + 1


def test_seams_agree_on_both_sides_and_enclose_charts(segmented: Any) -> None:
    mesh = segmented.current_mesh()
    bits = mesh.face_custom_scalar_attribute_array("seam_edges").astype(int)
    charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    cut = (bits[:, None] & np.array([1, 2, 4]) != 0).ravel()
    pairs = edges_of(mesh.face_matrix())
    first, second = pairs.T
    assert (cut[first] == cut[second]).all()
    between = charts[first // 3] != charts[second // 3]
    assert cut[first][between].all() and between.any()


def test_flattening_keeps_each_charts_area(segmented: Any) -> None:
    segmented.compute_texcoord_parametrization_charts_per_wedge(pack=False)
    mesh = segmented.current_mesh()
    charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    flat = mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2)
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    e1, e2 = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    signed = (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]) / 2
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (signed > 0).all()
    np.testing.assert_allclose(
        np.bincount(charts, signed),
        np.bincount(charts, np.linalg.norm(normals, axis=1) / 2),
        rtol=1e-5,
    )


def test_packing_fills_the_unit_square(segmented: Any) -> None:
    segmented.compute_texcoord_parametrization_charts_per_wedge(pack=False)
    segmented.apply_texcoord_chart_packing_per_wedge()
    flat = segmented.current_mesh().wedge_tex_coord_matrix()
    assert flat.min() >= 0 and flat.max() <= 1
    assert np.ptp(flat, axis=0).max() > 0.98
    measures = segmented.get_parametrization_measures()
    assert measures["overlapping_faces_number"] == 0
    assert 0.4 < measures["packing_efficiency"] <= 1


def test_neighbors_differ_in_color(segmented: Any) -> None:
    segmented.compute_color_by_chart_per_face()
    mesh = segmented.current_mesh()
    charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    colors = mesh.face_color_matrix()[:, :3]
    for chart in set(charts):
        assert np.ptp(colors[charts == chart], axis=0).max() == 0
    first, second = edges_of(mesh.face_matrix()).T // 3
    between = charts[first] != charts[second]
    difference = np.abs(colors[first] - colors[second]).max(axis=1)[between]
    assert difference.min() > 0.1


@pytest.mark.parametrize(
    ("parameter", "value"),
    [
        ("charts_number", -1),
        ("max_chart_l2_stretch", 0.5),
        ("max_fitting_error", 0.0),
        ("max_fitting_error", -1.0),
    ],
)
def test_bad_parameters_are_refused_before_anything_changes(
    parameter: str, value: float, segmented: Any, pymeshlab: ModuleType
) -> None:
    mesh = segmented.current_mesh()

    def state() -> list[np.ndarray]:
        return [
            mesh.vertex_matrix().copy(),
            mesh.face_matrix().copy(),
            mesh.face_color_matrix().copy(),
            mesh.face_custom_scalar_attribute_array("chart_id").copy(),
            mesh.face_custom_scalar_attribute_array("seam_edges").copy(),
        ]

    before = state()
    with pytest.raises(pymeshlab.PyMeshLabException, match=parameter):
        segmented.apply_filter(DCHARTS, **{parameter: value})
    for old, new in zip(before, state(), strict=True):
        np.testing.assert_array_equal(old, new)


def test_flattening_without_charts_cuts_each_component(meshset: Callable) -> None:
    ms = meshset(meshes.cube())
    result = ms.apply_filter(FLATTEN)
    assert (result["charts_number"], result["cut_charts_number"]) == (1, 1)
    flat = ms.apply_filter("get_parametrization_measures")
    assert (flat["disk_charts_number"], flat["flipped_faces_number"]) == (1, 0)


def test_texture_coordinates_are_needed_where_they_are_read(
    meshset: Callable, pymeshlab: ModuleType
) -> None:
    for name in ("get_parametrization_measures", "apply_texcoord_chart_packing_per_wedge"):
        with pytest.raises(pymeshlab.PyMeshLabException, match="expected wedge texture"):
            meshset(meshes.cube()).apply_filter(name)


def test_plugin_paths_exist() -> None:
    assert [path.is_file() for path in devseg.plugin_paths()] == [True, True]
