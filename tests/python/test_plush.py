"""Plush toy seams and the preview of the sewn toy, through PyMeshLab and the command line."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from devseg.cli import main

PLUSH = "compute_segmentation_plush_seams_per_face"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"


def capsule(meshset: Callable) -> object:
    """A closed tube with round ends."""
    around, along = 24, 30
    vertices = [(0.0, 0.0, -1.6)]
    for k in range(1, along):
        t = np.pi * k / along
        radius, z = 0.5 * np.sin(t) ** 0.5, -1.6 * np.cos(t)
        for i in range(around):
            a = 2 * np.pi * i / around
            vertices.append((radius * np.cos(a), radius * np.sin(a), z))
    vertices.append((0.0, 0.0, 1.6))
    faces = [(0, 1 + (i + 1) % around, 1 + i) for i in range(around)]
    for k in range(along - 2):
        for i in range(around):
            a, b = 1 + k * around + i, 1 + k * around + (i + 1) % around
            faces += [(a, b, b + around), (a, b + around, a + around)]
    last, top = 1 + (along - 2) * around, len(vertices) - 1
    faces += [(last + i, last + (i + 1) % around, top) for i in range(around)]
    return meshset((np.array(vertices), np.array(faces)))


def test_patches_keep_their_strain_and_become_the_toy(meshset: Callable) -> None:
    meshes = capsule(meshset)
    found = meshes.apply_filter(PLUSH)
    assert found["strain_99"] <= 0.2
    assert found["largest_strain"] <= 0.4
    assert found["all_developable"]
    assert 1 <= found["charts_number"] <= 8
    flat = meshes.apply_filter(FLATTEN, method="LPFB")
    assert flat["charts_number"] == found["charts_number"]
    assert flat["overlap_cuts_number"] == flat["mended_charts_number"] == 0
    measures = meshes.apply_filter("get_parametrization_measures")
    assert 0 < measures["strain_99"] <= 0.2
    assert measures["strain_99"] <= measures["largest_strain"] <= 0.4
    assert measures["mean_strain"] <= 0.06
    assert max(abs(np.array(measures["seam_mismatch_percent"]))) < 0.2
    assert measures["flipped_faces_number"] == measures["overlapping_faces_number"] == 0
    assert measures["disk_charts_number"] == measures["charts_number"]
    preview = meshes.apply_filter("generate_sewn_preview")
    assert preview["mean_distance_share"] < 0.02
    assert meshes.mesh_number() == 2


def test_without_strain_patches_keep_their_area(meshset: Callable) -> None:
    meshes = capsule(meshset)
    found = meshes.apply_filter(PLUSH, max_strain=0.0)
    assert found["all_developable"]
    assert found["strain_99"] == found["largest_strain"] == 0
    meshes.apply_filter(FLATTEN, method="LPFB Even Areas")
    even = meshes.apply_filter("get_parametrization_measures")
    assert even["max_area_change"] <= 0.15
    meshes.apply_filter(FLATTEN, method="LPFB")
    least = meshes.apply_filter("get_parametrization_measures")
    assert least["charts_number"] == even["charts_number"] == found["charts_number"]
    assert least["strain_99"] <= even["strain_99"]


def test_selected_faces_are_a_material(meshset: Callable) -> None:
    meshes = capsule(meshset)
    with pytest.raises(Exception, match="material_borders"):
        meshes.apply_filter(PLUSH, material_borders="Face selection")
    meshes.compute_selection_by_condition_per_face(condselect="(z0+z1+z2) > 0.01")
    selected = meshes.current_mesh().face_selection_array()
    assert 0 < selected.sum() < len(selected)
    meshes.apply_filter(PLUSH, material_borders="Face selection")
    ids = meshes.current_mesh().face_custom_scalar_attribute_array("chart_id")
    assert not set(ids[selected]) & set(ids[~selected])


def test_skeleton_files(meshset: Callable, tmp_path: Path) -> None:
    meshes = capsule(meshset)
    file = tmp_path / "bones.obj"
    file.write_text("v 0 0 -1.5\nv 0 0 1.5\nl 1 2\n")
    assert meshes.apply_filter(PLUSH, skeleton_file=str(file))["bones_number"] == 1
    file.write_text("v 0 0\n")
    with pytest.raises(Exception, match="line 1"):
        meshes.apply_filter(PLUSH, skeleton_file=str(file))


def test_command_line_flattens_plush_with_lpfb(meshset: Callable, tmp_path: Path) -> None:
    meshes = capsule(meshset)
    file = tmp_path / "toy.ply"
    meshes.save_current_mesh(str(file))
    out = tmp_path / "out"
    assert main(["run", str(file), "-o", str(out), "--method", "plush", "--formats", "ply"]) == 0
    result = json.loads((out / "toy.json").read_text())
    assert result["parameters"][FLATTEN]["method"] == 4  # LPFB
    assert result["parametrization"]["strain_99"] <= 0.2
