"""Putting the plugins into a MeshLab, finding it, and telling whether they fit."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

import hosts
from conftest import ROOT
from devseg.info import host_lines
from devseg.installations import Installation, find_installations, plugin_flavour
from devseg.plugins import PLUGIN_FILES

FLAVOUR = "meshlab-2020.09"


@pytest.fixture
def meshlab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Installation:
    """A MeshLab of its own at an unusual place, with a plugin folder of its own."""
    hosts.flavour_plugins(FLAVOUR)
    found = [host for host in find_installations() if host.flavour == FLAVOUR]
    if not found:
        hosts.missing(f"no {FLAVOUR} on this machine")
    folder = tmp_path / "MeshLab"
    (folder / "plugins").mkdir(parents=True)
    (folder / found[0].library.name).symlink_to(found[0].library)
    monkeypatch.setenv("DEVSEG_MESHLAB_DIR", str(folder))
    return next(host for host in find_installations() if host.plugins is not None)


def install(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "scripts/install_plugins.sh", *arguments],
        cwd=ROOT,
        env=dict(os.environ),
        capture_output=True,
        text=True,
    )


def files(host: Installation) -> list[Path]:
    assert host.plugins is not None
    return [host.plugins / name for name in PLUGIN_FILES]


def test_plugins_are_installed_found_and_removed(meshlab: Installation) -> None:
    assert meshlab.flavour == FLAVOUR
    assert "not installed; run scripts/install_plugins.sh" in host_lines(meshlab)[0]
    done = install()
    assert done.returncode == 0, done.stderr
    assert f"installed {' '.join(PLUGIN_FILES)} ({FLAVOUR}) into {meshlab.plugins}" in done.stderr
    assert [plugin_flavour(file) for file in files(meshlab)] == [FLAVOUR, FLAVOUR]
    assert f"the plugins fit ({FLAVOUR})" in host_lines(meshlab)[0]
    done = install("--uninstall")
    assert done.returncode == 0 and f"removed {' '.join(PLUGIN_FILES)} from" in done.stderr
    assert not any(file.exists() for file in files(meshlab))


def test_plugins_of_another_flavour_are_told(meshlab: Installation) -> None:
    for file in files(meshlab):
        file.write_bytes(b"devseg-flavour=meshlab-2025.07\0")
    expected = f"do not fit: expected {FLAVOUR}, found meshlab-2025.07; run scripts/install_plu"
    assert expected in host_lines(meshlab)[0]


def test_files_of_others_are_not_removed(meshlab: Installation) -> None:
    for file in files(meshlab):
        file.write_bytes(b"something else")
    done = install("--uninstall")
    assert done.returncode == 0 and "removed nothing from" in done.stderr
    assert all(file.exists() for file in files(meshlab))


def test_meshlab_that_is_not_there_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DEVSEG_MESHLAB_DIR", str(tmp_path))
    done = install()
    assert done.returncode == 1 and "error: found no MeshLab" in done.stderr


def test_unknown_version_fits_nothing(tmp_path: Path) -> None:
    library = tmp_path / "libmeshlab-common.so"
    library.write_bytes(b"\x002031.04\0")
    host = Installation(library, "2031.04", tmp_path)
    assert host.flavour is None
    assert "no flavour of the plugins fits this version" in host_lines(host)[0]


@pytest.mark.parametrize("arguments", [["nonsense"], ["meshlab-2019.01"], []])
def test_only_known_flavours_are_built(arguments: list[str]) -> None:
    done = subprocess.run(
        ["bash", "scripts/build_host.sh", *arguments], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 2 and "FLAVOUR: pymeshlab-2025.07" in done.stdout
