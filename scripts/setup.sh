#!/usr/bin/env bash
# Set-up shared by quickstart.sh and test.sh: system packages, MeshLab headers, Python
# environment, build. Every step looks first whether its work is already done, so that a second
# run costs less than a second. Source it and call devseg_setup, or run it by itself.
#
#   MESHLAB_SOURCE_DIR     MeshLab source tree to take the headers from
#   DEVSEG_DEBIAN_MIRROR   Debian mirror for the headers, where the machine's own is not Debian's
#   DEVSEG_PYTHON          Python interpreter for .venv
#   XDG_CACHE_HOME         parent of the devseg cache (default ~/.cache)

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
setup_log=$root/build/setup.log
# Checkouts at different places share what is compiled.
export CCACHE_BASEDIR=$root
# shellcheck source=scripts/meshlab_headers.sh
source "$root/scripts/meshlab_headers.sh"

system_packages=(build-essential cmake ninja-build qtbase5-dev libqt5opengl5-dev libeigen3-dev
    libgtest-dev libcgal-dev libpolyclipping-dev libjpeg-dev libglew-dev pkg-config xz-utils dpkg-dev
    ccache python3-venv python3-dev fonts-dejavu-core fonts-droid-fallback)

# What is built: everything, tests as well.
build_targets=(all)

# Fresh machines install their own updates for minutes: so many seconds we wait for apt's locks, and
# look again after each pause.
lock_timeout=900
lock_pause=10

# All messages go to stderr: stdout belongs to the results (devseg run --json).
say() { printf 'devseg: %s\n' "$*" >&2; }
die() {
    say "error: $*"
    exit 1
}

# logged COMMAND...: runs it silently, its output goes to the log.
logged() {
    printf '\n$ %s\n' "$*" >>"$setup_log"
    "$@" >>"$setup_log" 2>&1 </dev/null
}

# or_die WHAT COMMAND...: as logged, but a failure shows the end of the log and stops.
or_die() {
    local what=$1
    shift
    logged "$@" && return
    tail -n 30 "$setup_log" >&2
    die "$what failed; the end of the log is above, all of it in ${setup_log#"$root"/}"
}

missing_packages() {
    local package
    for package in "$@"; do
        [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
            printf '%s\n' "$package"
    done
}

ensure_system_packages() {
    # Elsewhere than on Debian, a Debian mirror needs Debian's keys.
    [[ -z ${DEVSEG_DEBIAN_MIRROR:-} ]] || system_packages+=(debian-archive-keyring)
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        say "no apt here: please install the equivalents of ${system_packages[*]}"
        return
    fi
    local -a missing as_root=()
    mapfile -t missing < <(missing_packages "${system_packages[@]}")
    ((${#missing[@]})) || return 0
    if ((EUID != 0)); then
        command -v sudo >/dev/null ||
            die "these packages are missing, and only root may install them: ${missing[*]}"
        as_root=(sudo)
    fi
    say "installing system packages: ${missing[*]}"
    update_lists "${as_root[@]}"
    or_die "installing the system packages" "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get -o "DPkg::Lock::Timeout=$lock_timeout" install -y --no-install-recommends \
        "${missing[@]}"
}

# update_lists [sudo]: apt waits for the lock of its packages, but not for that of its lists.
update_lists() {
    local start=$SECONDS
    until logged "$@" env LC_ALL=C apt-get -o "DPkg::Lock::Timeout=$lock_timeout" update; do
        # A third-party source that does not answer must not stop us: the install decides.
        tail -n 5 "$setup_log" | grep -q 'Could not get lock' || return 0
        ((SECONDS - start < lock_timeout)) || return 0
        say "waiting for other software that is installing packages"
        sleep "$lock_pause"
    done
}

# Prints the first Python that has a wheel of the given pymeshlab.
find_python() {
    local newest=14 candidate
    [[ $1 == 2022.* ]] && newest=11
    for candidate in ${DEVSEG_PYTHON:+"$DEVSEG_PYTHON"} python3 python3.{14,13,12,11,10} \
        /usr/bin/python3; do
        if "$candidate" -c "import sys, ensurepip
sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, $newest))" >/dev/null 2>&1; then
            command -v "$candidate"
            return
        fi
    done
    return 1
}

# ensure_venv WHEEL: .venv with pymeshlab==WHEEL, this package (editable) and the test tools.
ensure_venv() {
    local wheel=$1 venv=$root/.venv python stamp
    stamp=$(printf '%s %s ' "$root" "$wheel" && sha256sum <"$root/pyproject.toml")
    if [[ -x $venv/bin/devseg && $(cat "$venv/.devseg-stamp" 2>/dev/null) == "$stamp" ]] &&
        "$venv/bin/python" -c '' 2>/dev/null; then
        return
    fi
    python=$(find_python "$wheel") ||
        die "pymeshlab $wheel needs Python 3.10 or later that it has a wheel for;" \
            "set DEVSEG_PYTHON to one (found: $(python3 --version 2>&1))"
    say "creating the Python environment .venv (pymeshlab $wheel)"
    rm -rf "$venv"
    or_die "creating .venv" "$python" -m venv "$venv"
    local -a packages=(-e "${root}[test]")
    local -a pip=("$venv/bin/python" -m pip install --disable-pip-version-check)
    logged "${pip[@]}" "${packages[@]}" ||
        or_die "installing the Python packages" "${pip[@]}" "${packages[@]}"
    if [[ $wheel == 2022.* ]]; then
        # Built before NumPy 2; the pin in pyproject.toml names the main target.
        or_die "installing pymeshlab $wheel" "${pip[@]}" "pymeshlab==$wheel" 'numpy<2'
    fi
    printf '%s\n' "$stamp" >"$venv/.devseg-stamp"
}

# pymeshlab_dir PYTHON: where its pymeshlab is installed.
pymeshlab_dir() {
    "$1" -c 'import importlib.util as u; print(u.find_spec("pymeshlab").submodule_search_locations[0])'
}

# ensure_build PRESET ARGUMENT...: configures when something changed, and builds what is stale.
ensure_build() {
    local preset=$1 build=$root/build/$1 stamp
    shift
    stamp="$root $*"
    cd "$root" || die "cannot enter $root"
    if [[ ! -f $build/build.ninja || $(cat "$build/.devseg-stamp" 2>/dev/null) != "$stamp" ]]; then
        say "configuring build/$preset"
        rm -f "$build/CMakeCache.txt"
        or_die "configuring" cmake --preset "$preset" "$@"
        printf '%s\n' "$stamp" >"$build/.devseg-stamp"
    fi
    # ninja -n tells, without building, whether there is anything to say.
    ninja -C "$build" -n "${build_targets[@]}" 2>/dev/null | grep -q 'no work to do' && return
    say "building the plugins (build/$preset)"
    or_die "building" cmake --build --preset "$preset" --target "${build_targets[@]}"
}

# ensure_main_build: what quickstart.sh and the tests use.
ensure_main_build() {
    local pymeshlab
    pymeshlab=$(pymeshlab_dir "$root/.venv/bin/python") ||
        die "pymeshlab is not in .venv; remove .venv and run this again"
    ensure_build release "-DDEVSEG_FLAVOUR=pymeshlab-$headers_version" \
        "-DMESHLAB_SOURCE_DIR=$headers_dir" "-DDEVSEG_PYMESHLAB_DIR=$pymeshlab"
}

start_log() {
    mkdir -p "$root/build"
    date >"$setup_log"
}

devseg_setup() {
    start_log
    ensure_system_packages
    find_headers
    ensure_venv "$wheel_version"
    (ensure_main_build) || exit 1
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
    set -euo pipefail
    devseg_setup
fi
