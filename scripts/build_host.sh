#!/usr/bin/env bash
# Builds both plugins for one host, into build/FLAVOUR/plugins, and prints that folder. Does the
# set-up that this needs first.
#   scripts/build_host.sh FLAVOUR
# FLAVOUR: pymeshlab-2025.07, pymeshlab-2022.02, meshlab-2025.07, meshlab-2022.02, meshlab-2020.09
#   MESHLAB_SOURCE_DIR      MeshLab source tree of that version
#   DEVSEG_MESHLAB_LIB_DIR  folder of libmeshlab-common, for a MeshLab that is not found by itself
# The other variables are those of setup.sh.

# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

# old_wheel_python: the Python of the environment with pymeshlab 2022.2, beside the headers.
old_wheel_python() {
    local wheel=2022.2.post4 venv=$devseg_cache/pymeshlab-2022.2 python part
    if [[ ! -f $venv/.complete ]] || ! "$venv/bin/python" -c '' 2>/dev/null; then
        python=$(find_python "$wheel") ||
            die "pymeshlab $wheel needs Python 3.10 or 3.11; set DEVSEG_PYTHON to one"
        say "creating the Python environment of pymeshlab $wheel (once)"
        rm -rf "$venv"
        or_die "creating $venv" "$python" -m venv "$venv"
        # Built before NumPy 2.
        or_die "installing pymeshlab $wheel" "$venv/bin/python" -m pip install \
            --disable-pip-version-check "pymeshlab==$wheel" 'numpy<2'
        touch "$venv/.complete"
    fi
    printf '%s\n' "$venv/bin/python"
}

# library_dir FLAVOUR: folder of the library of a MeshLab of that flavour on this machine, if any.
library_dir() {
    [[ -z ${DEVSEG_MESHLAB_LIB_DIR:-} ]] || {
        printf '%s\n' "$DEVSEG_MESHLAB_LIB_DIR"
        return
    }
    python3 -I "$root/scripts/devseg/installations.py" |
        awk -F '\t' -v flavour="$1" '$1 == flavour { print $2; exit }'
}

# build_host FLAVOUR: builds its plugins.
build_host() {
    local flavour=$1 version=${1##*-} python library
    local -a host=()
    if [[ -n ${MESHLAB_SOURCE_DIR:-} ]]; then
        source_dir_headers "$version" "$flavour"
    else
        cached_headers "$version" || no_headers "$version"
    fi
    case $flavour in
    pymeshlab-2025.07)
        ensure_venv 2025.7.post1
        host=("-DDEVSEG_PYMESHLAB_DIR=$(pymeshlab_dir "$root/.venv/bin/python")")
        ;;
    pymeshlab-2022.02)
        python=$(old_wheel_python) || exit 1
        host=("-DDEVSEG_PYMESHLAB_DIR=$(pymeshlab_dir "$python")")
        ;;
    *)
        library=$(library_dir "$flavour")
        [[ -n $library ]] || say "no $flavour on this machine: its symbols are not checked"
        host=("-DDEVSEG_MESHLAB_LIB_DIR=$library")
        ;;
    esac
    (ensure_build "$flavour" "-DMESHLAB_SOURCE_DIR=$headers_dir" "${host[@]}") || exit 1
}

known_flavours() {
    sed -n 's/^# FLAVOUR: //p' "${BASH_SOURCE[0]}" | tr -d ,
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
    set -euo pipefail
    if [[ $# != 1 || $1 == -* || " $(known_flavours) " != *" $1 "* ]]; then
        sed -n '2,9s/^# //p' "${BASH_SOURCE[0]}"
        [[ ${1:-} == -h || ${1:-} == --help ]] && exit
        exit 2
    fi
    start_log
    ensure_system_packages
    build_host "$1"
    printf '%s\n' "build/$1/plugins"
fi
