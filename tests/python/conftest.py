"""What all tests share: the plugins in the real host, files and the command line."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import devseg
import meshes
from devseg import host
from devseg.cli import main

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def pymeshlab() -> ModuleType:
    """The host with both plugins."""
    devseg.load_plugins()
    return host.pymeshlab()


@pytest.fixture(scope="session")
def flattened(pymeshlab: Any) -> Any:
    """A closed ball in several pieces."""
    ms = pymeshlab.MeshSet()
    ms.create_sphere(radius=1.0, subdiv=4)
    ms.compute_segmentation_variational_shape_approximation_per_face(charts_number=6)
    ms.compute_seams_charts_to_disks_per_edge()
    ms.compute_texcoord_parametrization_charts_per_wedge()
    return ms


@pytest.fixture(scope="session")
def data() -> Path:
    """Meshes from elsewhere, that the project cannot ship."""
    folder = Path(os.environ.get("DEVSEG_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no meshes in {folder} (DEVSEG_DATA)")
    return folder


@pytest.fixture(scope="session")
def evaluator() -> ModuleType:
    """Measures of an atlas by other hands: shares no code with the project."""
    path = Path(
        os.environ.get("DEVSEG_EVALUATOR", ROOT.parent / "shared" / "eval" / "evalatlas.py")
    )
    if not path.is_file():
        pytest.skip(f"no evaluator at {path} (DEVSEG_EVALUATOR)")
    spec = importlib.util.spec_from_file_location("evalatlas", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def obj(tmp_path: Path) -> Callable[[meshes.Mesh, str], Path]:
    """Writes a mesh as an OBJ file outside of the output folder."""

    def write(mesh: meshes.Mesh, name: str = "mesh") -> Path:
        folder = tmp_path / "input"
        folder.mkdir(exist_ok=True)
        return meshes.write_obj(folder / f"{name}.obj", *mesh)

    return write


# pymeshlab may keep a pointer to the log of a MeshSet and use it for later ones.
_alive: list[Any] = []


@pytest.fixture
def meshset(pymeshlab: ModuleType) -> Callable[[meshes.Mesh], Any]:
    """A MeshSet that holds one mesh."""

    def make(mesh: meshes.Mesh) -> Any:
        meshset = pymeshlab.MeshSet()
        _alive.append(meshset)
        meshset.add_mesh(pymeshlab.Mesh(*mesh))
        return meshset

    return make


@pytest.fixture
def fails(capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs a command that must fail with one line, which it returns."""

    def run(*arguments: str | Path) -> str:
        capfd.readouterr()
        assert main([str(a) for a in arguments]) == 1
        out, error = capfd.readouterr()
        assert out == ""
        assert error.startswith("devseg: error: ")
        assert error.count("\n") == 1 and error.endswith("\n")
        assert "Traceback" not in error and "unexpected" not in error
        return error

    return run
