#!/usr/bin/env bash
# Builds MeshLab 2025.07 with its window, once, into the cache: the tests of the window use it where
# no such MeshLab is installed. Takes some ten minutes on two processors.
#   scripts/build_meshlab.sh

# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

# build_meshlab: does nothing where it is there already.
build_meshlab() {
    local version=2025.07 target=$devseg_cache/meshlab-2025.07-window part jobs
    [[ -x $target/meshlab && -e $target/plugins/libedit_select.so ]] && return
    mkdir -p "$devseg_cache"
    part=$(mktemp -d -p "$devseg_cache") || return 1
    say "fetching the MeshLab $version sources"
    fetch_tree "$version" "$part/tree" all || {
        rm -rf "$part"
        no_headers "$version"
    }
    say "building MeshLab $version (once)"
    jobs=${DEVSEG_JOBS:-$(nproc)}
    or_die "configuring MeshLab" cmake -S "$part/tree" -B "$part/build" -G Ninja \
        -DCMAKE_BUILD_TYPE=Release -DMESHLAB_BUILD_MINI=ON -DCMAKE_BUILD_RPATH_USE_ORIGIN=ON \
        -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_C_COMPILER_LAUNCHER=ccache
    or_die "building MeshLab" cmake --build "$part/build" -j "$jobs" \
        --target meshlab io_base filter_select edit_select
    rm -rf "$target"
    mv -T "$part/build/src/distrib" "$target"
    rm -rf "$part"
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
    set -euo pipefail
    start_log
    system_packages+=(libglu1-mesa-dev)
    ensure_system_packages
    build_meshlab
    say "MeshLab 2025.07 is in $devseg_cache/meshlab-2025.07-window"
fi
