#!/usr/bin/env bash
# Builds dist/devseg-VERSION-py3-none-manylinux_2_35_x86_64.whl and the source distribution beside
# it, does the set-up that this needs first, and prints both files.
#   DEVSEG_CLIPPER_SOURCE   folder with polyclipping/clipper.cpp and .hpp of Clipper 6.4.2, where no
#                           Debian mirror has its source
# The other variables are those of setup.sh.

# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

clipper_version=6.4.2
# What is compiled in from Debian's packages; each has its licences in its own file.
compiled_in=(libeigen3-dev libcgal-dev libboost-dev libjpeg-dev fonts-dejavu-core
    fonts-droid-fallback)
tree=$root/build/wheel/tree
# Bytes that the wheel may have.
largest=12000000

# clipper_source: sets clipper, fetching the sources once.
clipper_source() {
    local part
    clipper=${DEVSEG_CLIPPER_SOURCE:-$devseg_cache/clipper-$clipper_version}
    [[ ! -f $clipper/polyclipping/clipper.cpp ]] || return 0
    [[ -z ${DEVSEG_CLIPPER_SOURCE:-} ]] ||
        die "DEVSEG_CLIPPER_SOURCE=$clipper has no polyclipping/clipper.cpp"
    say "fetching the sources of Clipper $clipper_version (once)"
    mkdir -p "$devseg_cache"
    part=$(mktemp -d -p "$devseg_cache") || die "cannot write into $devseg_cache"
    if debian_tarball libpolyclipping "$clipper_version" "$part/apt" bookworm trixie testing; then
        mkdir -p "$part/tree/polyclipping"
        logged tar -xf "$part"/apt/libpolyclipping_*.orig.tar.* -C "$part/apt" --strip-components=1
        cp "$part"/apt/cpp/clipper.[ch]pp "$part/tree/polyclipping" &&
            cp "$part/apt/License.txt" "$part/tree/polyclipping" &&
            { mv -T "$part/tree" "$clipper" 2>/dev/null || true; }
    fi
    rm -rf "$part"
    [[ -f $clipper/polyclipping/clipper.cpp ]] ||
        die "found the sources of Clipper on no Debian mirror; set DEVSEG_CLIPPER_SOURCE to a" \
            "folder with polyclipping/clipper.cpp of Clipper $clipper_version"
}

# copy_tree: the files of the project, and those that only distributions have.
copy_tree() {
    local package licence
    rm -rf "$tree"
    mkdir -p "$tree"
    cd "$root" || die "cannot enter $root"
    if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
        git ls-files -z | xargs -0 -I{} sh -c '[ -e "$1" ] && printf "%s\0" "$1"' _ {} |
            tar --null -T - -cf - | tar -xf - -C "$tree"
    else
        # A source distribution that was unpacked.
        tar --exclude=./build --exclude=./.venv --exclude=./dist --exclude='*.egg-info' \
            --exclude=__pycache__ -cf - . | tar -xf - -C "$tree"
    fi
    cp scripts/wheel/setup.py "$tree"
    printf 'graft .\nglobal-exclude *.so *.pyc\n' >"$tree/MANIFEST.in"
    # Tools of distributions take files of such names as licences.
    cp "$clipper/polyclipping/License.txt" "$tree/LICENSE.clipper"
    cp io_pattern/page/three/LICENSE "$tree/LICENSE.three"
    for package in "${compiled_in[@]}"; do
        licence=/usr/share/doc/$package/copyright
        [[ -f $licence ]] || die "expected $licence, which the wheel must hold; found nothing"
        cp "$licence" "$tree/LICENSE.${package%-dev}"
    done
}

# check_wheel_file FILE: its size, its platform and what it needs of the system.
check_wheel_file() {
    local size
    size=$(stat -c %s "$1")
    ((size <= largest)) || die "$1 has $size bytes; expected at most $largest"
    or_die "the check by auditwheel" "$root/.venv/bin/python" "$root/scripts/wheel/check_tag.py" "$1" \
        "$(pymeshlab_dir "$root/.venv/bin/python")"
}

build_wheel() {
    local python=$root/.venv/bin/python pymeshlab wheel sdist
    pymeshlab=$(pymeshlab_dir "$python") || die "pymeshlab is not in .venv"
    clipper_source
    (ensure_build wheel "-DMESHLAB_SOURCE_DIR=$headers_dir" "-DDEVSEG_PYMESHLAB_DIR=$pymeshlab" \
        "-DDEVSEG_CLIPPER_SOURCE=$clipper") || exit 1
    say "making the wheel"
    copy_tree
    or_die "making the source distribution" "$python" -m build --no-isolation --sdist \
        --outdir "$tree/dist" "$tree"
    mkdir -p "$tree/scripts/devseg/plugins"
    or_die "copying the plugins" install -m 644 -t "$tree/scripts/devseg/plugins" --strip \
        "$root"/build/wheel/plugins/lib{filter_devseg,io_pattern}.so
    or_die "making the stand-ins" "$python" "$root/scripts/wheel/stand_ins.py" "$pymeshlab" \
        "$tree/scripts/devseg/plugins"
    or_die "making the wheel" "$python" -m build --no-isolation --wheel --outdir "$tree/dist" "$tree"
    wheel=$(echo "$tree"/dist/*.whl) sdist=$(echo "$tree"/dist/*.tar.gz)
    check_wheel_file "$wheel"
    mkdir -p "$root/dist"
    rm -f "$root"/dist/devseg-*
    mv "$wheel" "$sdist" "$root/dist"
    printf 'dist/%s\n' "$(basename "$sdist")" "$(basename "$wheel")"
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
    set -euo pipefail
    start_log
    ensure_system_packages
    find_headers
    [[ $wheel_version == 2025.7.post1 ]] || die "wheels are for pymeshlab 2025.7.post1 only"
    ensure_venv "$wheel_version"
    build_wheel
fi
