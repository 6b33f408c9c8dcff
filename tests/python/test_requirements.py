"""What is missing on a machine is told in one line."""

from __future__ import annotations

import importlib.metadata
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import devseg
from conftest import ROOT
from devseg import requirements


def run(code: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(ROOT / "scripts"), **environment},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )


COMMAND = "import sys, devseg.cli; sys.exit(devseg.cli.main(['run', 'a.obj', '-o', 'out']))"


def test_a_system_that_is_too_old_is_told(tmp_path: Path) -> None:
    for path in devseg.plugin_paths():
        shutil.copy(path, tmp_path)
    plugin = tmp_path / "libfilter_devseg.so"
    data = plugin.read_bytes()
    assert b"GLIBC_2.34" in data
    plugin.write_bytes(data.replace(b"GLIBC_2.34", b"GLIBC_9.34"))
    done = run(COMMAND, tmp_path, DEVSEG_PLUGIN_DIR=str(tmp_path))
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert "expected glibc 9.34 or later, as Debian 12 and Ubuntu 22.04 have it" in done.stderr
    assert "found glibc 2." in done.stderr


def test_another_pymeshlab_is_told(tmp_path: Path) -> None:
    (tmp_path / "pymeshlab-2023.12.post3.dist-info").mkdir()
    done = run(f"import sys; sys.path.insert(0, '.')\n{COMMAND}", tmp_path)
    assert done.stderr == (
        "devseg: error: expected pymeshlab 2025.7.post1, found 2023.12.post3; "
        "pip install pymeshlab==2025.7.post1\n"
    )


def test_no_pymeshlab_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> str:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "version", missing)
    monkeypatch.setattr(sys, "path", [])
    advice = requirements.version_advice()
    assert advice == (
        "expected pymeshlab 2025.7.post1, found none; pip install pymeshlab==2025.7.post1"
    )


def test_the_version_is_the_one_of_the_package() -> None:
    assert requirements.version_advice() is None
    for name in ("pymeshlab", "numpy", "pillow"):
        assert requirements.installed_version(name) == importlib.metadata.version(name)
    pyproject = (ROOT / "pyproject.toml").read_text()
    assert f'"pymeshlab=={requirements.PYMESHLAB}"' in pyproject


@pytest.mark.parametrize(
    ("error", "advice"),
    [
        (
            "libGL.so.1: cannot open shared object file: No such file or directory",
            "pymeshlab needs libGL.so.1, which is missing: apt install libgl1 libopengl0 libcom",
        ),
        ("libodd.so.3: cannot open shared object file", "libodd.so.3: cannot open shared object"),
        ("undefined symbol: x\n y", "undefined symbol: x y; run scripts/quickstart.sh"),
    ],
)
def test_errors_of_the_loader_say_what_to_do(error: str, advice: str) -> None:
    assert requirements.loading_advice(error).startswith(advice)


def test_without_readers_nothing_is_read(tmp_path: Path) -> None:
    code = """
import os, sys, types, devseg.cli
class Finder:
    def find_spec(self, name, path=None, target=None):
        if name == "pymeshlab":
            os.write(2, b"Cannot load library /x/libio_base.so: (libOpenGL.so.0: cannot open "
                        b"shared object file: No such file or directory)\\n")
            sys.modules[name] = types.ModuleType(name)
            import importlib.machinery
            return importlib.machinery.ModuleSpec(name, self)
    def create_module(self, spec): return types.ModuleType("pymeshlab")
    def exec_module(self, module): pass
sys.meta_path.insert(0, Finder())
"""
    done = run(code + COMMAND, tmp_path)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert "pymeshlab cannot read files: pymeshlab needs libOpenGL.so.0, which is" in done.stderr
