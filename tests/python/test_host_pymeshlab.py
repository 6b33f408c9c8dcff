"""Every filter in the two pymeshlabs: what they report of it is what was declared, and it runs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import hosts
import reference
import wheel_jobs
from conftest import ROOT

WHEELS = {"pymeshlab-2025.07": Path(sys.executable), "pymeshlab-2022.02": hosts.OLD_PYTHON}


@pytest.fixture(params=WHEELS)
def wheel(request: pytest.FixtureRequest) -> str:
    return request.param


def in_wheel(flavour: str, jobs: list[dict[str, Any]], folder: Path) -> list[list[str]]:
    """What `wheel_jobs.run` answers in the environment of a flavour."""
    if not WHEELS[flavour].is_file():
        hosts.missing(f"no environment for {flavour}; run scripts/build_host.sh {flavour}")
    built = "release" if flavour == "pymeshlab-2025.07" else flavour
    order = {
        "plugins": [str(path) for path in hosts.flavour_plugins(built)],
        "jobs": jobs,
        "answer": str(folder / "answer.json"),
    }
    done = subprocess.run(
        [WHEELS[flavour], wheel_jobs.__file__],
        input=json.dumps(order),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads((folder / "answer.json").read_text())


def test_every_filter_runs_and_is_reported_as_declared(
    wheel: str, tmp_path: Path, pymeshlab: ModuleType
) -> None:
    table = hosts.declarations()
    sample = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / wheel_jobs.SAMPLE
    jobs = []
    for number, filter_ in enumerate(table):
        output = tmp_path / f"{number}.svg"
        steps = [(s["python_name"], hosts.told(s, output, sample)) for s in hosts.prepared(filter_)]
        mesh = hosts.sample(filter_, sample, tmp_path)
        history = str(tmp_path / f"{number}.mlx")
        jobs.append({"mesh": str(mesh), "steps": steps, "history": history})
    answers = in_wheel(wheel, jobs, tmp_path)
    for number, (filter_, answer) in enumerate(zip(table, answers, strict=True)):
        name = filter_["menu_name"]
        assert answer == sorted(r["name"] for r in filter_["results"]), name
        expected = hosts.with_values([filter_], tmp_path / f"{number}.svg", sample)[0]
        reported = hosts.reported_script(tmp_path / f"{number}.mlx")
        assert hosts.without_extensions(reported[name]) == hosts.declared_script(expected), name
        hosts.record(wheel, name, "as declared, runs")


def test_shipped_scripts_run(wheel: str, tmp_path: Path) -> None:
    scripts = sorted((ROOT / reference.MLX).glob("*.mlx"))
    jobs = [
        {"script": str(script), "save": str(tmp_path / f"{script.stem}.svg")} for script in scripts
    ]
    in_wheel(wheel, jobs, tmp_path)
    for script in scripts:
        svg = (tmp_path / f"{script.stem}.svg").read_text()
        assert svg.count("<path") > 1 and svg.rstrip().endswith("</svg>")
    hosts.record(wheel, "Saving as SVG", "runs")


def test_both_wheels_give_the_same_pattern(tmp_path: Path) -> None:
    texts = []
    for flavour in WHEELS:
        file = tmp_path / f"{flavour}.svg"
        in_wheel(
            flavour,
            [{"script": str(ROOT / reference.MLX / "dcharts.mlx"), "save": str(file)}],
            tmp_path,
        )
        texts.append(np.array(file.read_text().split()))
    np.testing.assert_array_equal(*texts)
