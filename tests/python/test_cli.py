"""The command line as a user meets it."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import meshes
from conftest import ROOT
from devseg import methods, quickstart
from devseg.cli import main
from devseg.errors import DevsegError
from devseg.load import load_mesh
from devseg.pipeline import Session
from devseg.plugins import load_plugins

USAGE = [
    [],
    ["unknown"],
    ["run"],
    ["run", "a.obj"],
    ["run", "a.obj", "-o", "out", "--charts", "0"],
    ["run", "a.obj", "-o", "out", "--charts", "-3"],
    ["run", "a.obj", "-o", "out", "--charts", "two"],
    ["run", "a.obj", "-o", "out", "--charts", "99999999999"],
    ["run", "a.obj", "-o", "out", "--charts", "auto", "--method", "vsa"],
    ["run", "a.obj", "-o", "out", "--charts", "4", "--max-l2-stretch", "1.01"],
    ["run", "a.obj", "-o", "out", "--max-l2-stretch", "1"],
    ["run", "a.obj", "-o", "out", "--max-linf-stretch", "1.2", "--method", "mcgim"],
    ["run", "a.obj", "-o", "out", "--max-fitting-error", "0"],
    ["run", "a.obj", "-o", "out", "--max-fitting-error", "nan"],
    ["run", "a.obj", "-o", "out", "--height-mm", "-1"],
    ["run", "a.obj", "-o", "out", "--mm-per-unit", "inf"],
    ["run", "a.obj", "-o", "out", "--height-mm", "10", "--mm-per-unit", "1"],
    ["run", "a.obj", "-o", "out", "--method", "guess"],
    ["run", "a.obj", "-o", "out", "--flatten", "guess"],
    ["run", "a.obj", "-o", "out", "--formats", "svg,doc"],
    ["run", "a.obj", "-o", "out", "--formats", ""],
    ["run", "a.obj", "b/a.ply", "-o", "out"],
    ["measure"],
    ["measure", "a.obj", "b.obj"],
]


@pytest.mark.parametrize("arguments", USAGE, ids=" ".join)
def test_wrong_usage_exits_with_two(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    assert stopped.value.code == 2
    assert list(tmp_path.iterdir()) == []


def test_input_is_never_overwritten(obj: Callable) -> None:
    path = obj(meshes.cube())
    before = path.read_bytes()
    with pytest.raises(SystemExit) as stopped:
        main(["run", str(path), "-o", str(path.parent), "--formats", "svg,obj"])
    assert stopped.value.code == 2
    assert path.read_bytes() == before


BAD_FILES = {
    "missing.obj": None,
    "empty.obj": b"",
    "words.ply": b"these are only words\n",
    "letter.doc": b"text",
    "points.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "nan.obj": b"v 0 0 0\nv 1 0 nan\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 3 4\n",
    "line.obj": b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
}


@pytest.mark.parametrize("name", BAD_FILES)
@pytest.mark.parametrize("command", ["run", "measure"])
def test_bad_file_is_one_line_and_no_output(
    name: str, command: str, tmp_path: Path, fails: Callable[..., str], pymeshlab: object
) -> None:
    path = tmp_path / name
    if BAD_FILES[name] is not None:
        path.write_bytes(BAD_FILES[name])
    before = sorted(tmp_path.iterdir())
    out = ["-o", tmp_path / "out"] if command == "run" else []
    error = fails(command, path, *out)
    assert name in error
    assert sorted(tmp_path.iterdir()) == before


def test_missing_plugins_say_what_to_do(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "import devseg; devseg.load_plugins()"],
        env={**os.environ, "DEVSEG_PLUGIN_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    assert str(tmp_path) in done.stderr and "scripts/quickstart.sh" in done.stderr


SHAPES = {
    "triangle": (np.eye(3), np.array([[0, 1, 2]])),
    "cube": meshes.cube(),
    "two components": meshes.joined(meshes.cube(), meshes.cylinder(), (5, 0, 0)),
    "three fins": meshes.three_fins(),
    "moebius": meshes.moebius(),
    "sphere": meshes.sphere(),
    "tiny": (1e-7 * meshes.sphere()[0], meshes.sphere()[1]),
    "far": (meshes.sphere()[0] + 1e6, meshes.sphere()[1]),
}


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_works_or_fails_in_one_line(
    name: str, obj: Callable, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = obj(SHAPES[name], name)
    # More charts than faces are refused, with reason.
    charts = min(4, len(SHAPES[name][1]))
    out = tmp_path / "out"
    code = main(["run", str(path), "-o", str(out), "--charts", str(charts), "--longest-mm", "99"])
    error = capfd.readouterr().err
    if code != 0:
        assert error.startswith("devseg: error: ") and error.count("\n") == 1
        assert not out.exists()
    else:
        assert all(line.startswith("devseg: warning: ") for line in error.splitlines())
        # Seams of equal length may take pieces out of their places in the layout.
        warnings = [line for line in error.splitlines() if "above the layout" not in line]
        assert bool(warnings) == (name in ("three fins", "moebius"))  # what was worked around
        files = sorted(p.name for p in out.iterdir())
        assert files == [f"{name}.{e}" for e in ("json", "ply", "png", "svg")]
        flat = json.loads((out / f"{name}.json").read_text())["parametrization"]
        assert flat["flipped_faces_number"] == 0
        assert flat["disk_charts_number"] == flat["charts_number"] >= 1
    # These have nothing wrong with them.
    if name not in ("three fins", "moebius"):
        assert code == 0


def test_a_failed_filter_swallows_no_later_warning(obj: Callable) -> None:
    load_plugins()
    path = obj(meshes.three_fins(), "fins")
    session = Session(path, load_mesh(path).meshes)
    with pytest.raises(DevsegError):  # there are no texture coordinates yet
        session.call("get_parametrization_measures")
    session.apply("compute_segmentation_dcharts_per_face", charts_number=3)
    assert any("edge" in warning for warning in session.warnings)


def test_result_is_the_same_every_time(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.sphere())
    for name in ("a", "b"):
        arguments = ["-o", str(tmp_path / name), "--charts", "5", "--formats", "svg,ply,obj"]
        assert main(["run", str(path), *arguments]) == 0
    for first in sorted((tmp_path / "a").iterdir()):
        texts = [(tmp_path / run / first.name).read_bytes() for run in ("a", "b")]
        if first.suffix == ".json":
            texts = [json.loads(text) for text in texts]
            seconds = [text.pop("seconds") for text in texts]
            assert seconds[0].keys() == seconds[1].keys()
        assert texts[0] == texts[1], first.name


def run_devseg(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "devseg", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_bounds_on_the_stretch_find_the_number_of_charts(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.sphere())
    stretches = []
    seams = []
    for bound in (1.05, 1.0005):
        limits = ["--max-l2-stretch", bound, "--height", "9cm", "--seams", "edges"]
        done = run_devseg("run", path, "-o", tmp_path, "--json", *limits)
        assert done.returncode == 0
        result = json.loads(done.stdout)
        filter_name = "compute_segmentation_dcharts_per_face"
        assert result["parameters"][filter_name]["charts_number"] == 0
        stretches.append(result["parametrization"]["l2_stretch"])
        seams.append(result["parametrization"]["seam_length"])
        assert 1 < stretches[-1] <= bound
    assert seams[0] < seams[1]


def test_every_chart_keeps_its_bound(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.sphere())
    done = run_devseg("run", path, "-o", tmp_path, "--json", "--charts", 1)
    assert done.returncode == 0
    result = json.loads(done.stdout)
    assert result["parametrization"]["l2_stretch"] <= 1.02
    assert result["method_results"]["charts_above_bound_number"] == 0


def test_json_is_all_there_is_on_stdout(obj: Callable, tmp_path: Path) -> None:
    path = obj(meshes.cylinder(radius=1, height=3))
    out = tmp_path / "out"
    options = ["--json", "--charts", 3, "--seed", 7, "--mm-per-unit", 100, "--effort", "fast"]
    done = run_devseg("run", path, "-o", out, *options)
    assert (done.returncode, done.stderr) == (0, "")
    result = json.loads(done.stdout)
    assert result == json.loads((out / "mesh.json").read_text())
    parameters = result["parameters"]["compute_segmentation_dcharts_per_face"]
    assert parameters["charts_number"] == 3 and parameters["random_seed"] == 7
    flattening = result["parameters"]["compute_texcoord_parametrization_charts_per_wedge"]
    assert flattening["effort"] == 0
    assert set(result["versions"]) >= {"devseg", "pymeshlab", "python"}
    assert set(result["seconds"]) >= {"load", "segment", "flatten", "measure", "svg", "ply"}
    assert result["mesh"] == {"vertices": 624, "faces": 1152}
    assert result["outputs"]["svg"] == "mesh.svg"
    # A tube is developable: its pieces are isometric up to the floor of the numerics.
    assert result["parametrization"]["l2_stretch"] == pytest.approx(1, abs=1e-4)
    measured = run_devseg("measure", out / "mesh.ply", "--json")
    assert (measured.returncode, measured.stderr) == (0, "")
    again = json.loads(measured.stdout)
    assert again["segmentation"]["charts_number"] == result["segmentation"]["charts_number"]
    # Texture coordinates are stored as 32 bit numbers in PLY.
    for name, value in result["parametrization"].items():
        if name != "packing_efficiency":
            assert again["parametrization"][name] == pytest.approx(value, rel=1e-3, abs=1e-3)


def test_several_inputs_are_a_list(
    obj: Callable, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    paths = [str(obj(meshes.cube(), "a")), str(obj(meshes.cylinder(), "b"))]
    arguments = ["-o", str(tmp_path / "out"), "--charts", "4", "--formats", "svg", "--json"]
    assert main(["run", *paths, *arguments]) == 0
    results = json.loads(capfd.readouterr().out)
    assert [r["input"] for r in results] == ["a.obj", "b.obj"]
    assert not (tmp_path / "out" / "a.ply").exists()


def test_summary_names_the_files(
    obj: Callable, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["run", str(obj(meshes.cube())), "-o", str(out), "--charts", "3"]) == 0
    lines = capfd.readouterr().out.splitlines()
    for label, extension in (("pattern", "svg"), ("mesh", "ply"), ("picture", "png")):
        assert f"{label:<9} {out / f'mesh.{extension}'}" in lines
    assert re.fullmatch(r"figures   \d+ charts, L2 stretch [\d.]+, .*", lines[-1])
    with Image.open(out / "mesh.png") as picture:
        assert picture.size == (1600, 800)


def test_measure_needs_texture_coordinates(obj: Callable, fails: Callable[..., str]) -> None:
    assert "expected texture coordinates" in fails("measure", obj(meshes.cube()))


def test_filter_errors_are_passed_on(obj: Callable, tmp_path: Path, fails: Callable) -> None:
    error = fails("run", obj(meshes.cube()), "-o", tmp_path / "out", "--fold-angle", 999)
    assert "180" in error and "999" in error and "Failed to apply" not in error
    assert not (tmp_path / "out").exists()


def test_failing_stage_leaves_nothing(
    obj: Callable, tmp_path: Path, fails: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full_disk(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("devseg.render.render_pair", full_disk)
    error = fails("run", obj(meshes.cube()), "-o", tmp_path / "out", "--charts", 3)
    assert "No space left" in error
    assert not (tmp_path / "out").exists()


def test_info_names_plugins_and_filters(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["info"]) == 0
    text = capfd.readouterr().out
    for part in ("libio_pattern.so", "compute_segmentation_dcharts_per_face", "meshlabserver"):
        assert part in text
    assert "not usable" not in text


def test_quickstart_finds_mesh_among_the_options(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = []
    monkeypatch.setattr(quickstart, "run_command", lambda args, _: seen.append(args))
    assert quickstart.main(["--charts", "7", "toy.obj", "-o", "there"]) == 0
    assert quickstart.main(["-o", "there", "--height-mm", "90"]) == 0
    assert quickstart.main([]) == 0
    assert [a.input[0].name for a in seen] == ["toy.obj", "bunny.obj", "bunny.obj"]
    assert [str(a.out) for a in seen] == ["there", "there", "out"]
    assert [a.height_mm for a in seen] == [None, 90, quickstart.SAMPLE_HEIGHT_MM]
    assert seen[1].input[0].is_file()


def test_import_is_cheap() -> None:
    code = "import devseg, sys; sys.exit('pymeshlab' in sys.modules or 'PIL' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT).returncode == 0


def test_every_option_reaches_a_filter() -> None:
    for method in methods.METHODS.values():
        assert set(method.options) <= set(methods.METHOD_OPTIONS)
