"""The parts of the set-up that can be tried without installing anything."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from conftest import ROOT

DEB822 = """# comment
Types: deb
URIs: http://security.test/debian-security
Suites: bookworm-security
Components: main

Types: deb
Enabled: no
URIs: http://disabled.test/debian
Suites: bookworm
Components: main

Types: deb deb-src
URIs: http://mirror.test/debian
Suites: bookworm bookworm-updates
Components: main contrib
Signed-By: /usr/share/keyrings/debian-archive-keyring.gpg
"""
CLASSIC = """# deb http://commented.test/debian bookworm main
deb [arch=amd64 signed-by=/k.gpg] http://tools.test/apt stable main
deb http://security.test/debian-security bookworm-security main
deb [ trusted=yes ] http://mirror.test/debian bookworm main
deb-src http://mirror.test/source bookworm main
"""


def shell(script: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "-c", f"source scripts/setup.sh; setup_log=/dev/null; {script}"],
        cwd=ROOT,
        env={"PATH": "/usr/bin:/bin", "HOME": "/nonexistent", **environment},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("name", "text"),
    [("sources.list.d/debian.sources", DEB822), ("sources.list", CLASSIC)],
)
def test_mirror_is_the_one_of_the_main_archive(tmp_path: Path, name: str, text: str) -> None:
    file = tmp_path / name
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    found = shell(f"debian_mirror '{tmp_path}' bookworm")
    assert found.stdout.split() == ["http://mirror.test/debian"]


def test_no_mirror_for_another_release(tmp_path: Path) -> None:
    (tmp_path / "sources.list").write_text(CLASSIC)
    assert shell(f"debian_mirror '{tmp_path}' noble").stdout == ""


def source_tree(folder: Path, version: str) -> Path:
    (folder / "src" / "common").mkdir(parents=True)
    (folder / "src" / "vcglib" / "vcg").mkdir(parents=True)
    (folder / "ML_VERSION").write_text(version)
    return folder


def test_source_dir_is_taken(tmp_path: Path) -> None:
    tree = source_tree(tmp_path, "2025.07")
    script = 'find_headers; echo "$headers_dir $headers_version $wheel_version"'
    found = shell(script, MESHLAB_SOURCE_DIR=str(tree))
    assert found.stdout.split() == [str(tree), "2025.07", "2025.7.post1"]
    assert "MeshLab headers 2025.07 (MESHLAB_SOURCE_DIR)" in found.stderr


@pytest.mark.parametrize("version", ["2022.02", None])
def test_source_dir_of_another_version_is_refused(tmp_path: Path, version: str | None) -> None:
    if version:
        source_tree(tmp_path, version)
    found = shell("find_headers", MESHLAB_SOURCE_DIR=str(tmp_path))
    assert found.returncode == 1
    assert (version or "no ML_VERSION") in found.stderr


def test_cached_headers_need_no_network(tmp_path: Path) -> None:
    tree = source_tree(tmp_path / "devseg" / "meshlab-2025.07", "2025.07\n")
    # Whoever fetches anything all the same, fails.
    script = 'fetch_debian() { exit 9; }; find_headers; echo "$headers_dir"'
    found = shell(script, XDG_CACHE_HOME=str(tmp_path))
    assert (found.returncode, found.stdout.strip()) == (0, str(tree))


def test_headers_and_wheel_are_never_mixed(tmp_path: Path) -> None:
    source_tree(tmp_path / "devseg" / "meshlab-2022.02", "2022.02")
    script = (
        "fetch_debian() { return 1; }; fetch_git() { return 1; }; find_python() { echo python3; };"
        'find_headers; echo "$headers_version $wheel_version"'
    )
    found = shell(script, XDG_CACHE_HOME=str(tmp_path))
    assert found.stdout.split() == ["2022.02", "2022.2.post4"]


def test_only_the_targets_asked_for_are_built(tmp_path: Path) -> None:
    # Of a folder that is configured, with a cmake that only tells what it is asked for.
    (tmp_path / "build" / "release").mkdir(parents=True)
    (tmp_path / "build" / "release" / "build.ninja").touch()
    (tmp_path / "build" / "release" / ".devseg-stamp").write_text(f"{tmp_path} \n")
    stubs = f"root={tmp_path}; setup_log=$root/log; cmake() {{ echo cmake $*; }}; ninja() {{ :; }}"
    for targets, expected in (("", "all"), ("build_targets=(one two); ", "one two")):
        done = shell(f"{stubs}; {targets}ensure_build release")
        assert done.returncode == 0, done.stderr
        built = (tmp_path / "log").read_text().splitlines()[-1]
        assert built == f"cmake --build --preset release --target {expected}"
    quickstart = (ROOT / "scripts" / "quickstart.sh").read_text()
    assert "build_targets=(filter_devseg io_pattern)" in quickstart


def test_help_needs_no_setup() -> None:
    done = subprocess.run(
        ["bash", "scripts/quickstart.sh", "--help"], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0 and "quickstart.sh [MESH]" in done.stdout


APT = """#!/bin/sh
echo "$@" >>"$CALLS"
case "$*" in
*update*)
    [ "$(grep -c update "$CALLS")" -gt 2 ] && exit 0
    echo "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 7"
    exit 100
    ;;
esac
"""


def test_locks_of_apt_are_waited_for(tmp_path: Path) -> None:
    calls = tmp_path / "calls"
    for name, text in (
        ("apt-get", APT),
        ("dpkg-query", "#!/bin/sh\n"),
        ("sudo", '#!/bin/sh\nexec "$@"\n'),
    ):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    variables = f"setup_log={tmp_path}/log; lock_pause=0; system_packages=(one)"
    path = f"{tmp_path}:/usr/bin:/bin"
    done = shell(f"{variables}; ensure_system_packages", PATH=path, CALLS=str(calls))
    assert done.returncode == 0
    assert done.stderr.count("waiting for other software") == 2
    updates, installs = calls.read_text().splitlines()[:-1], calls.read_text().splitlines()[-1]
    assert len(updates) == 3
    assert installs.startswith("-o DPkg::Lock::Timeout=900 install") and installs.endswith(" one")
