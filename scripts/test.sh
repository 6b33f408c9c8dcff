#!/usr/bin/env bash
# All tests: unit tests (ctest), what the sources must keep to, then pytest on the real hosts, whose
# closing line ends the output. Fails if any of them failed.
#   DEVSEG_GUI_TESTS=1   builds MeshLab 2025.07 into the cache, once, and tests the windows as well;
#                        they are also tested where it is there already
set -euo pipefail

# shellcheck source=scripts/build_host.sh
source "$(dirname "${BASH_SOURCE[0]}")/build_host.sh"
# shellcheck source=scripts/build_meshlab.sh
source "$root/scripts/build_meshlab.sh"

# MeshLab with its batch server, an X server without a screen, used with mouse and keyboard, and a
# reader of PDF files.
system_packages+=(meshlab xvfb xauth xdotool poppler-utils)
# Browsers for the page of a pattern; elsewhere the packages are not the browsers themselves.
if [[ $(. /etc/os-release && echo "${ID:-}") == debian ]]; then
    system_packages+=(chromium chromium-driver firefox-esr)
fi
devseg_setup
if [[ ${DEVSEG_GUI_TESTS:-} == 1 ]]; then
    system_packages=(libglu1-mesa-dev)
    ensure_system_packages
    build_meshlab
fi
flavours=(meshlab-2020.09 meshlab-2022.02 meshlab-2025.07)
if find_python 2022.2.post4 >/dev/null; then
    flavours+=(pymeshlab-2022.02)
fi
for flavour in "${flavours[@]}"; do
    # It is of one version only, and devseg_setup has taken it.
    MESHLAB_SOURCE_DIR='' build_host "$flavour"
done
# Debian 12 has every host: there, one that is missing is a failure.
if [[ $(. /etc/os-release && echo "${ID:-} ${VERSION_ID:-}") == "debian 12" ]]; then
    export DEVSEG_HOST_TESTS=required
fi
cd "$root"

failed=()
check() {
    local what=$1
    shift
    printf '== %s\n' "$what"
    "$@" </dev/null || failed+=("$what")
}

# Two types of one name are undefined behaviour that no compiler sees: the linker compares them.
one_definition() {
    cmake --preset odr >/dev/null && cmake --build --preset odr
}

# Reads beyond a container often go unseen: here they end the program. What runs every filter again
# and again takes minutes, and is left to ctest.
checked() {
    cmake --preset checked >/dev/null && cmake --build --preset checked || return 1
    local shards i failed=0
    shards=$(nproc)
    local -a runs=()
    for ((i = 0; i < shards; ++i)); do
        GTEST_TOTAL_SHARDS=$shards GTEST_SHARD_INDEX=$i build/checked/tests/devseg_unit_tests \
            --gtest_brief=1 --gtest_filter='-DeclaredFilters.*:SelectedOnly.*:Keep.*' &
        runs+=($!)
    done
    for i in "${runs[@]}"; do
        wait "$i" || failed=1
    done
    return "$failed"
}

check ctest ctest --preset release --parallel "$(nproc)"
check "one definition" one_definition
check "assertions of the library" checked
check walls .venv/bin/python scripts/check_walls.py
check reference .venv/bin/python scripts/reference.py --check
check "ruff check" .venv/bin/ruff check scripts tests docs/examples
check "ruff format" .venv/bin/ruff format --check scripts tests docs/examples
check mypy .venv/bin/mypy
# What newer systems compile does not run with the C library that the wheel promises.
if [[ ${DEVSEG_HOST_TESTS:-} == required ]]; then
    check "wheel, built" scripts/build_wheel.sh
    check "wheel, installed" scripts/check_wheel.sh
fi
if ((${#failed[@]})); then
    printf 'devseg: failed so far: %s\n' "${failed[*]}"
fi
# Files side by side: those of a file share what they have made. Readers that crash on broken files, as
# some tests have them do, need not tell where.
check pytest .venv/bin/python -m pytest --numprocesses "$(nproc)" --dist loadfile \
    -p no:faulthandler tests/python
((${#failed[@]} == 0))
