#!/usr/bin/env bash
# Installs the wheel in dist, which scripts/build_wheel.sh makes, into empty environments, makes a
# pattern of the Stanford bunny with it, and prints a row for each: what of, seconds of both.
#   scripts/check_wheel.sh [PYTHON | debian:DIR]...
# PYTHON is an interpreter; default: the system's. DIR is a Debian without anything else, such as
#   debootstrap --variant=minbase --include=python3-venv testing DIR
# whose Python is used inside of it, by root; its packages are fetched from outside.

# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

# What runs in the environment: the command line, the arrays, and workers of a batch.
trial='
import importlib.metadata, importlib.util, pathlib, subprocess, sys
folder = pathlib.Path(sys.argv[1])
package = pathlib.Path(importlib.util.find_spec("pymeshlab").origin).parent
bunny = package / "tests/sample_meshes/bunny10k_textured.obj"
devseg = pathlib.Path(sys.executable).parent / "devseg"
subprocess.run([devseg, "run", bunny, "-o", folder / "out", "--height-mm", "200"], check=True)
assert (folder / "out/bunny10k_textured.svg").stat().st_size > 10000
info = subprocess.run([devseg, "info"], check=True, capture_output=True, text=True).stdout
assert "the plugins fit (pymeshlab-2025.07)" in info, info
cube = package / "tests/sample_meshes/cube.obj"
subprocess.run([devseg, "batch", cube, "-o", folder / "batch"], check=True)
files = importlib.metadata.files("devseg")
licences = {file.name.removeprefix("LICENSE.") for file in files if "licenses" in file.parts}
inside = {"clipper", "libboost", "libcgal", "libeigen3", "libjpeg", "fonts-dejavu-core",
          "fonts-droid-fallback", "three"}
assert licences == {"LICENSE", *inside}, licences
import devseg
corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
atlas = devseg.unwrap(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
assert atlas.uv.shape == (4, 3, 2) and atlas.measures["flipped_faces_number"] == 0
'

# in_debian DIR COMMAND...: runs it inside, with the network of the outside.
in_debian() {
    local dir=$1
    shift
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 chroot "$dir" "$@"
}

# check_python WHEEL PYTHON
check_python() {
    local wheel=$1 python=$2 folder version start installed
    version=$("$python" -c 'import platform; print(platform.python_version())') ||
        die "$python is no Python"
    folder=$(mktemp -d)
    or_die "making an environment" "$python" -m venv "$folder/venv"
    start=$SECONDS
    # Nothing to compile with is in the path.
    or_die "installing the wheel into Python $version" env PATH="$folder/venv/bin" \
        "$folder/venv/bin/python" -m pip install --disable-pip-version-check "$wheel"
    installed=$SECONDS
    # Nothing of this machine but its C library: no compiler, no Qt, none of our own paths.
    or_die "running the wheel with Python $version" env -i PATH="$folder/venv/bin" HOME="$folder" \
        LANG=C.UTF-8 "$folder/venv/bin/python" -c "$trial" "$folder"
    row "Python $version" "$((installed - start))" "$((SECONDS - installed))"
    rm -rf "$folder"
}

# check_debian WHEEL DIR: its Python may be one that this machine has none of.
check_debian() {
    local wheel=$1 dir=$2 version start installed
    version=$(in_debian "$dir" python3 -c 'import platform; print(platform.python_version())') ||
        die "$dir has no Python; see the head of scripts/check_wheel.sh"
    rm -rf "$dir/opt/wheel"
    mkdir -p "$dir/opt/wheel"
    cp "$wheel" "$dir/opt/wheel"
    start=$SECONDS
    or_die "fetching packages" python3 -m pip download --disable-pip-version-check -d \
        "$dir/opt/wheel" --only-binary :all: --platform manylinux_2_35_x86_64 \
        --platform manylinux_2_28_x86_64 --platform manylinux2014_x86_64 --implementation cp \
        --python-version "${version%.*}" "$wheel"
    or_die "making an environment" in_debian "$dir" python3 -m venv --clear /opt/venv
    or_die "installing the wheel into Python $version" in_debian "$dir" /opt/venv/bin/pip install \
        --no-index --find-links /opt/wheel "/opt/wheel/$(basename "$wheel")"
    installed=$SECONDS
    rm -rf "$dir/opt/trial"
    mkdir "$dir/opt/trial"
    or_die "running the wheel in $dir" in_debian "$dir" /opt/venv/bin/python -c "$trial" /opt/trial
    row "Python $version in a bare Debian" "$((installed - start))" "$((SECONDS - installed))"
}

# row WHAT INSTALLING RUNNING
row() {
    printf '%s: installed in %s s, run in %s s\n' "$@"
}

main() {
    local -a wheels
    local one
    wheels=("$root"/dist/devseg-*.whl)
    ((${#wheels[@]} == 1)) && [[ -f ${wheels[0]} ]] ||
        die "expected one wheel in dist, found others; remove them, or run scripts/build_wheel.sh"
    (($#)) || set -- /usr/bin/python3
    for one in "$@"; do
        if [[ $one == debian:* ]]; then
            check_debian "${wheels[0]}" "${one#debian:}"
        else
            check_python "${wheels[0]}" "$one"
        fi
    done
}

set -euo pipefail
start_log
main "$@"
