"""Our measures against an independent evaluator that shares no code with the project."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from devseg.load import load_mesh
from devseg.methods import METHODS
from devseg.pipeline import RunOptions, Session, flatten_mesh
from devseg.progress import Progress

MESHES = ["bunny_69451", "horse_19996", "fandisk_9926", "rockerarm_20088", "fertility_9000"]
MESHES += ["tshirt_8710"]


@pytest.mark.parametrize("name", MESHES)
def test_measures_agree(
    name: str, data: Path, evaluator: ModuleType, pymeshlab: ModuleType
) -> None:
    path = data / "public" / f"{name}.ply"
    meshset = load_mesh(path).meshes
    options = RunOptions(Path(), METHODS["dcharts"], {}, "symmetric-dirichlet", ("svg",), {})
    measures = flatten_mesh(Session(path, meshset), options, Progress(name))
    ours = measures["parametrization"]
    mesh = meshset.current_mesh()
    theirs = evaluator.evaluate(
        mesh.vertex_matrix(),
        mesh.face_matrix(),
        mesh.wedge_tex_coord_matrix().reshape(-1, 3, 2),
        mesh.face_custom_scalar_attribute_array("chart_id").astype(int),
    )
    assert ours["charts_number"] == theirs["charts"] == theirs["charts_by_ids"]
    assert ours["disk_charts_number"] == theirs["disks"] == theirs["charts"]
    assert ours["flipped_faces_number"] == theirs["flipped"] == 0
    assert theirs["mirrored_charts"] == 0
    assert theirs["degenerate_uv"] == 0
    assert theirs["overlap_inter_frac"] < 1e-6
    assert ours["l2_stretch"] == pytest.approx(theirs["l2"], rel=0.01)
    assert ours["linf_stretch"] == pytest.approx(theirs["linf"], rel=0.01)
    length = theirs["seam_len"] * np.sqrt(theirs["area3d"])
    assert ours["seam_length"] == pytest.approx(length, rel=0.01)
    self_overlap = theirs["self_overlapping_charts"] > 0
    assert (ours["overlapping_faces_number"] > 0) == self_overlap
