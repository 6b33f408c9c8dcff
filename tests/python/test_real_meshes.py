"""The command line over a folder of sixty meshes, and the job that runs it over any folder."""

from __future__ import annotations

import csv
import importlib
import importlib.util
import json
import os
import sys
from pathlib import Path
from types import ModuleType

import pytest

import gltf_files
import meshes
from conftest import ROOT


@pytest.fixture(autouse=True)
def _own_plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    """The job names copies of the plugins by the environment: other tests have their own."""
    monkeypatch.setenv("DEVSEG_PLUGIN_DIR", os.environ.get("DEVSEG_PLUGIN_DIR", ""))


FORMATS = ("obj", "ply", "stl", "off", "glb")

SHAPES: dict[str, meshes.Mesh] = {
    "cube": meshes.cube(),
    "tube": meshes.cylinder(),
    "low_tube": meshes.cylinder(around=6, along=1),
    "ball": meshes.sphere(),
    "coarse_ball": meshes.sphere(around=8, along=4),
    "moebius": meshes.moebius(),
    "fins": meshes.three_fins(),
    "two": meshes.joined(meshes.cube(), meshes.cylinder(), (5, 0, 0)),
    "in_metres": (0.001 * meshes.sphere()[0], meshes.sphere()[1]),
}

SAMPLES = ("airplane.obj", "bone.ply", "bunny10k_textured.obj", "colored_airplane.ply", "cow.obj")

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
# Texts of files, and a word of the reason for which they are refused.
BROKEN = {
    "empty.obj": ("", "found an empty one"),
    "zero.obj": (TRIANGLE + "f 0 1 2\n", "line 4 names vertex 0"),
    "beyond.obj": (TRIANGLE + "f 1 2 9\n", "line 4 names vertex 9"),
    "points.obj": (TRIANGLE, "no faces"),
    "nan.obj": (TRIANGLE + "v nan 0 0\nf 1 2 3\nf 2 3 4\n", "finite coordinates"),
    "words.ply": ("only words\n", "cannot be read"),
    "short.ply": (
        "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\nend_header\n",
        "cut off",
    ),
    "words.gltf": ("only words\n", "expected JSON"),
}


def write_shapes(folder: Path, pymeshlab: ModuleType) -> None:
    for name, (vertices, faces) in SHAPES.items():
        meshset = pymeshlab.MeshSet()
        meshset.add_mesh(pymeshlab.Mesh(vertices, faces))
        for extension in FORMATS:
            path = folder / extension / f"{name}.{extension}"
            path.parent.mkdir(exist_ok=True)
            if extension == "glb":
                gltf_files.write_glb(path, *gltf_files.document((vertices, faces)))
            else:
                meshset.save_current_mesh(str(path))


def write_broken(folder: Path) -> dict[str, str]:
    """The reasons by name."""
    folder.mkdir()
    for name, (text, _) in BROKEN.items():
        (folder / name).write_text(text)
    reasons = {name: reason for name, (_, reason) in BROKEN.items()}
    scene, data = gltf_files.document(meshes.cube())
    scene["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    gltf_files.write_glb(folder / "packed.glb", scene, data)
    scene, data = gltf_files.document(meshes.cube())
    scene["nodes"][0]["children"] = [0]
    gltf_files.write_gltf(folder / "loop.gltf", scene, data)
    return {**reasons, "packed.glb": "it is compressed", "loop.gltf": "its own descendant"}


@pytest.fixture
def job(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "tests" / "bench"))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    return importlib.import_module("real_meshes")


def records(out: Path) -> dict[str, dict]:
    found = [json.loads(path.read_text()) for path in (out / "records").rglob("*.json")]
    return {record["mesh"]: record for record in found}


def test_sixty_meshes_end_as_patterns_or_with_a_reason(
    job: ModuleType, tmp_path: Path, pymeshlab: ModuleType, capfd: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "meshes", tmp_path / "out"
    folder.mkdir()
    write_shapes(folder, pymeshlab)
    reasons = write_broken(folder / "broken")
    wheel = importlib.util.find_spec("pymeshlab").submodule_search_locations[0]
    for name in SAMPLES:
        (folder / name).symlink_to(Path(wheel) / "tests" / "sample_meshes" / name)
    assert job.main([str(folder), "-o", str(out), "--", "--formats", "svg"]) == 0
    found = records(out)
    assert len(found) == len(SHAPES) * len(FORMATS) + len(reasons) + len(SAMPLES) == 60
    for name, record in found.items():
        if name.startswith("broken/"):
            assert record["ending"] == job.REFUSED, record
            assert reasons[name.removeprefix("broken/")] in record["reason"]
        else:
            assert record["ending"] == job.PATTERN, record
            assert record["flipped"] == record["overlapping"] == 0, record
    assert "60 meshes, 50 patterns, 10 refused, 0 killed" in capfd.readouterr().out
    with (out / "report.csv").open() as file:
        assert len(list(csv.DictReader(file))) == 60
    page = (out / "index.html").read_text()
    assert page.count("<img ") == len(list((out / "pictures").rglob("*.png"))) == 50
    assert "line 4 names vertex 9" in page
    assert not any(out.rglob("*.svg"))


def test_a_run_that_was_stopped_goes_on(
    job: ModuleType, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "meshes", tmp_path / "out"
    folder.mkdir()
    for name in "abcd":
        (folder / f"{name}.obj").write_text(TRIANGLE + "f 1 2 3\n")
    assert job.main([str(folder), "-o", str(out), "--half", "odd"]) == 0
    first = records(out)
    assert sorted(first) == ["b.obj", "d.obj"]
    capfd.readouterr()
    assert job.main([str(folder), "-o", str(out)]) == 0
    assert "1/2 " in capfd.readouterr().out
    assert {name: records(out)[name] for name in first} == first and len(records(out)) == 4
    assert list(job.chosen_meshes(job.parse([str(folder), "--every", "3"]))) == ["a.obj", "d.obj"]


def test_a_run_keeps_its_plugins(
    job: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, others = tmp_path / "out", tmp_path / "others"
    copies = job.keep_plugins(out, None)
    monkeypatch.setenv("DEVSEG_PLUGIN_DIR", str(tmp_path / "nothing"))
    assert job.keep_plugins(out, None) == copies
    others.mkdir()
    for path in copies.iterdir():
        (others / path.name).write_bytes(path.read_bytes() + b" ")
    with pytest.raises(SystemExit, match="other plugins"):
        job.keep_plugins(out, others)
