# shellcheck shell=bash
# MeshLab's headers (src/common, vcglib) of exactly the version that a host was built from. No
# registry has a development package; Debian's source package carries them.
# Sourced by setup.sh, which provides say, die, logged, find_python and setup_log.
: "${setup_log:?source setup.sh instead}"

# Upstream's repository, for machines that reach it and no Debian mirror.
meshlab_git=${DEVSEG_MESHLAB_GIT:-https://github.com/cnr-isti-vclab/meshlab}
devseg_cache=${XDG_CACHE_HOME:-$HOME/.cache}/devseg

# tree_version DIR: the version of a MeshLab source tree; fails where it is not one.
tree_version() {
    [[ -d $1/src/common && -f $1/ML_VERSION ]] && [[ -d $1/src/vcglib/vcg || -d $1/vcglib/vcg ]] &&
        tr -d '[:space:]' <"$1/ML_VERSION"
}

# debian_mirror APT_DIR CODENAME: the URI in the machine's own apt sources that serves the main
# archive of the release it runs.
debian_mirror() {
    local file
    for file in "$1"/sources.list.d/*.sources; do
        [[ -f $file ]] || continue
        # deb822: paragraphs of "Field: value"; every paragraph stands for URIs x Suites. The
        # blank line that is added ends the last one.
        { cat "$file" && printf '\n\n'; } | awk -v suite="$2" '
            /^#/ { next }
            /^[[:space:]]*$/ {
                if (uri != "" && enabled != "no" && index(" " suites " ", " " suite " ")) {
                    print uri
                    exit
                }
                uri = suites = enabled = ""
                next
            }
            tolower($1) == "uris:" { uri = $2 }
            tolower($1) == "enabled:" { enabled = tolower($2) }
            tolower($1) == "suites:" { $1 = ""; suites = $0 " " }'
    done
    for file in "$1"/sources.list "$1"/sources.list.d/*.list; do
        [[ -f $file ]] || continue
        # classic: deb [options] URI SUITE COMPONENT...
        sed -n 's/^deb[[:space:]]\+\(\[[^]]*\][[:space:]]*\)\?//p' "$file" |
            awk -v suite="$2" '$2 == suite { print $1; exit }'
    done
}

# suites_of VERSION: the Debian suites that may have it.
suites_of() {
    case $1 in
    2020.09) echo bookworm ;;
    2022.02) echo trixie ;;
    *) echo testing unstable ;;
    esac
}

# extract_tree TARBALL DIR [all]: only the headers, not the 40 times larger rest, unless asked to.
extract_tree() {
    local -a only=(--wildcards '*/ML_VERSION' '*/src/common/*' '*/vcglib/*')
    [[ ${3:-} == all ]] && only=()
    logged tar -xf "$1" -C "$2" --strip-components=1 "${only[@]}"
}

# debian_tarball PACKAGE VERSION WORK SUITE...: the upstream tarball of a Debian source package, into
# WORK. The lists live in a directory of their own: the machine's apt stays as it is.
debian_tarball() {
    local package=$1 version=$2 work=$3 mirror=${DEVSEG_DEBIAN_MIRROR:-}
    local suite keyring options found
    shift 3
    command -v apt-get >/dev/null || return 1
    if [[ -z $mirror ]]; then
        mirror=$(
            . /etc/os-release
            [[ $ID != debian ]] || debian_mirror /etc/apt "${VERSION_CODENAME:-stable}" | head -n 1
        )
    fi
    [[ -n $mirror ]] || return 1
    keyring=/usr/share/keyrings/debian-archive-keyring.gpg
    [[ -f $keyring ]] && keyring="[signed-by=$keyring]" || keyring=
    for suite in "$@"; do
        rm -rf "$work"
        mkdir -p "$work/lists/partial" "$work/cache/archives/partial"
        printf 'deb-src %s %s %s main\n' "$keyring" "$mirror" "$suite" >"$work/sources.list"
        options=(-o "Dir::Etc::sourcelist=$work/sources.list" -o Dir::Etc::sourceparts=/dev/null
            -o "Dir::State::lists=$work/lists" -o "Dir::Cache=$work/cache"
            -o APT::Sandbox::User= -o Acquire::Retries=2)
        logged apt-get "${options[@]}" update || logged apt-get "${options[@]}" update || continue
        found=$(apt-cache "${options[@]}" showsrc "$package" 2>/dev/null |
            awk -v v="$version" '$1 == "Version:" && index($2, v) == 1 { print $2; exit }')
        [[ -n $found ]] || continue
        (cd "$work" && { fetch_source || fetch_source; }) && return
    done
    return 1
}

# The packaging files of a superseded revision vanish from mirrors, the tarball stays: tar only.
fetch_source() {
    logged apt-get "${options[@]}" source --tar-only --download-only "$package=$found"
}

# fetch_debian VERSION DIR [all]: takes the upstream tarball of Debian's source package.
fetch_debian() {
    local version=$1 target=$2 work=$2.apt
    local -a suites
    mapfile -t suites < <(suites_of "$version" | tr ' ' '\n')
    if debian_tarball meshlab "$version" "$work" "${suites[@]}"; then
        mkdir -p "$target"
        extract_tree "$work"/meshlab_*.orig.tar.* "$target" "${3:-}" || rm -rf "$target"
    fi
    rm -rf "$work"
    [[ -d $target ]]
}

# fetch_git VERSION DIR: the tagged upstream sources.
fetch_git() {
    local tag vcglib=src/vcglib
    [[ $1 == 2020.09 ]] && vcglib=vcglib
    command -v git >/dev/null || return 1
    for tag in "MeshLab-$1" "Meshlab-$1"; do
        rm -rf "$2"
        GIT_TERMINAL_PROMPT=0 logged timeout 300 git clone --quiet --depth 1 --branch "$tag" \
            "$meshlab_git" "$2" || continue
        GIT_TERMINAL_PROMPT=0 logged timeout 300 git -C "$2" submodule --quiet update --init \
            --depth 1 "$vcglib" || continue
        return
    done
    return 1
}

# fetch_tree VERSION DIR [all]: from the first place that has it; sets headers_from.
fetch_tree() {
    headers_from="Debian source package"
    if ! fetch_debian "$@"; then
        headers_from="upstream git"
        fetch_git "$1" "$2" || return 1
    fi
    [[ $(tree_version "$2") == "$1" ]]
}

# cached_headers VERSION: sets headers_dir and headers_from, fetching if need be.
cached_headers() {
    local version=$1 part
    headers_dir=$devseg_cache/meshlab-$version
    headers_from=cache
    [[ $(tree_version "$headers_dir") == "$version" ]] && return
    mkdir -p "$devseg_cache" || return 1
    say "fetching the MeshLab $version headers (once, 5 to 12 MB)"
    # Filled beside its final place and renamed: an interrupted run leaves no half tree behind.
    part=$(mktemp -d -p "$devseg_cache") || return 1
    if fetch_tree "$version" "$part/tree"; then
        rm -rf "$headers_dir"
        # Where another run was faster, its tree is as good as ours.
        mv -T "$part/tree" "$headers_dir" 2>/dev/null || true
    fi
    rm -rf "$part"
    [[ $(tree_version "$headers_dir") == "$version" ]]
}

# source_dir_headers VERSION: takes MESHLAB_SOURCE_DIR, which must be of that version.
source_dir_headers() {
    local found
    found=$(tree_version "$MESHLAB_SOURCE_DIR") ||
        die "MESHLAB_SOURCE_DIR=$MESHLAB_SOURCE_DIR has no ML_VERSION, src/common and" \
            "src/vcglib (a git submodule); give a complete MeshLab $1 tree"
    [[ $found == "$1" ]] ||
        die "MESHLAB_SOURCE_DIR holds MeshLab $found, but $2 needs" \
            "$1; unset it to have the headers fetched"
    headers_dir=$(cd "$MESHLAB_SOURCE_DIR" && pwd)
    headers_from=MESHLAB_SOURCE_DIR
}

no_headers() {
    tail -n 15 "$setup_log" >&2
    die "found MeshLab headers neither on a Debian mirror nor by git;" \
        "set MESHLAB_SOURCE_DIR to a MeshLab $1 source tree (with src/vcglib)," \
        "or DEVSEG_DEBIAN_MIRROR to a Debian mirror"
}

# find_headers: sets headers_dir, headers_version and wheel_version, which always belong together.
find_headers() {
    headers_version=2025.07
    wheel_version=2025.7.post1
    if [[ -n ${MESHLAB_SOURCE_DIR:-} ]]; then
        source_dir_headers "$headers_version" "pymeshlab $wheel_version"
    elif ! cached_headers "$headers_version"; then
        say "no source offers MeshLab $headers_version any more; trying the pair of 2022.02"
        headers_version=2022.02
        wheel_version=2022.2.post4
        if ! find_python "$wheel_version" >/dev/null || ! cached_headers "$headers_version"; then
            no_headers 2025.07
        fi
    fi
    say "MeshLab headers $headers_version ($headers_from)"
}
