"""The examples of the documentation run and write what they promise."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from conftest import ROOT

EXAMPLES = ROOT / "docs" / "examples"
# What each writes, and words that it prints.
WRITTEN = {
    "unwrap": (("torus.npz",), "charts, L2 stretch 1.0"),
    "sew_a_toy": (("pear.pdf", "sewn.npz"), "m2 of fabric"),
    "fold_a_model": (("gem.pdf",), "L2 stretch 1.000000"),
    "own_charts": (("box.svg",), "chart 5: 200 faces"),
    "progress": (("cancelled.txt",), "cancelled: nothing was changed"),
    "with_trimesh": (("capsule.glb",), "charts, "),
}


@pytest.mark.parametrize("name", WRITTEN)
def test_an_example_runs(name: str, tmp_path: Path) -> None:
    if name == "with_trimesh":
        pytest.importorskip("trimesh")
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / f"{name}.py"), str(tmp_path / "out")],
        env={**os.environ, "PYTHONPATH": str(ROOT / "scripts")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    files, words = WRITTEN[name]
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == sorted(files)
    assert words in done.stdout


def test_the_page_lists_them_all() -> None:
    page = (EXAMPLES / "README.md").read_text()
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(WRITTEN)
    assert all(f"[{name}.py]({name}.py)" in page for name in WRITTEN)
