"""The parts of making a wheel that need no wheel; scripts/check_wheel.sh tries the wheel itself."""

from __future__ import annotations

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from conftest import ROOT
from devseg import requirements

NAME = "devseg-1-py3-none-manylinux_2_35_x86_64.whl"
LIBRARY = "libQt5Core.so.5"


@pytest.fixture
def check_tag() -> ModuleType:
    path = ROOT / "scripts" / "wheel" / "check_tag.py"
    spec = importlib.util.spec_from_file_location("check_tag", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("platform", "library", "problem"),
    [
        ("manylinux_2_35_x86_64", "lib/libQt5Core.so.5", None),
        ("manylinux_2_9_x86_64", "lib/libQt5Core.so.5", None),
        ("manylinux_2_36_x86_64", "lib/libQt5Core.so.5", "found some of manylinux_2_36"),
        ("manylinux_2_35_x86_64", None, f"expected libraries .* found {LIBRARY}"),
        ("manylinux_2_35_x86_64", "../usr/lib/libQt5Core.so.5", f"found {LIBRARY}"),
    ],
)
def test_the_name_of_a_wheel_is_a_promise(
    platform: str, library: str | None, problem: str | None, check_tag: ModuleType,
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    place = library and str(tmp_path / library)
    found = {"sym_tag": platform, "external_libs": {LIBRARY: place}}
    monkeypatch.setattr(check_tag, "audit", lambda *_: found)
    lines = check_tag.problems(Path(NAME), tmp_path)
    if problem is None:
        assert lines == []
    else:
        assert len(lines) == 1 and re.search(problem, lines[0])


def test_a_wheel_without_plugins_is_not_made(tmp_path: Path) -> None:
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copy(ROOT / "scripts" / "wheel" / "setup.py", tmp_path)
    package = tmp_path / "scripts" / "devseg"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    done = subprocess.run(
        [sys.executable, "setup.py", "-q", "bdist_wheel"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1 and not list(tmp_path.rglob("*.whl"))
    assert done.stderr.splitlines()[-1].startswith("error: expected both plugins in scripts/devseg")


@pytest.fixture
def stand_ins(tmp_path: Path, pymeshlab: ModuleType) -> Path:
    """The folder of a package whose plugins are the stand-ins."""
    (tmp_path / "plugins").mkdir()
    script = ROOT / "scripts" / "wheel" / "stand_ins.py"
    package = Path(pymeshlab.__file__).parent
    subprocess.run([sys.executable, script, package, tmp_path / "plugins"], check=True)
    return tmp_path


def test_the_host_runs_without_libraries_of_screens(stand_ins: Path) -> None:
    """Those that are loaded already serve in place of the system's."""
    code = """
import ctypes, pathlib, sys
for file in pathlib.Path(sys.argv[1]).iterdir():
    ctypes.CDLL(str(file))
import devseg
corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
devseg.unwrap(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
print(pathlib.Path("/proc/self/maps").read_text())
"""
    done = subprocess.run(
        [sys.executable, "-c", code, stand_ins / "plugins"],
        check=True,
        capture_output=True,
        text=True,
    )
    assert len(set(re.findall(r"/stand_in_\w+", done.stdout))) == 3
    assert not re.search(r"/(libGL|libOpenGL|libcom_err)\.so", done.stdout)


def test_a_stand_in_is_loaded_for_a_library_that_is_missing(
    stand_ins: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (stand_ins / "plugins" / "stand_in_libc.so").write_text("no library: the system has one")
    shutil.copy(stand_ins / "plugins/stand_in_libGL.so", stand_ins / "plugins/stand_in_libodd.so")
    monkeypatch.setattr(requirements, "__file__", str(stand_ins / "requirements.py"))
    monkeypatch.setattr(
        requirements, "_PACKAGES", {"libc.so.6": "", "libodd.so.3": "", "no.so": ""}
    )
    requirements.load_stand_ins()
    assert str(stand_ins / "plugins/stand_in_libodd.so") in Path("/proc/self/maps").read_text()
