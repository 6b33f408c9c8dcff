#!/usr/bin/env bash
# Puts the plugins into every MeshLab found on this machine, each the flavour that fits it, and says
# what it did. `devseg info` lists what it finds.
#   scripts/install_plugins.sh [--uninstall]
#   DEVSEG_MESHLAB_DIR   a MeshLab at an unusual place (the folder with its programs): only this one

# shellcheck source=scripts/build_host.sh
source "$(dirname "${BASH_SOURCE[0]}")/build_host.sh"

plugin_files=(libfilter_devseg.so libio_pattern.so)

# with_rights DIR COMMAND...: as root where DIR is not ours.
with_rights() {
    local folder=$1
    shift
    if [[ -w $folder ]]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        die "$folder belongs to root; run this as root"
    fi
}

# install_into FLAVOUR DIR
install_into() {
    local file
    build_host "$1"
    for file in "${plugin_files[@]}"; do
        with_rights "$2" install -m 644 "$root/build/$1/plugins/$file" "$2/$file" ||
            die "could not write $2/$file"
    done
    say "installed ${plugin_files[*]} ($1) into $2"
}

# uninstall_from DIR: files of the same names that are not this project's stay.
uninstall_from() {
    local file removed=()
    for file in "${plugin_files[@]}"; do
        if [[ ! -f $1/$file ]] || ! grep -aq 'devseg-flavour=' "$1/$file"; then
            continue
        fi
        with_rights "$1" rm -f "$1/$file" || die "could not remove $1/$file"
        removed+=("$file")
    done
    say "removed ${removed[*]:-nothing} from $1"
}

main() {
    local action=install flavour library plugins found=0
    case $*: in
    :) ;;
    --uninstall:) action=uninstall ;;
    *)
        sed -n '2,6s/^# //p' "${BASH_SOURCE[0]}"
        [[ $* == -h || $* == --help ]] && exit
        exit 2
        ;;
    esac
    start_log
    while IFS=$'\t' read -r flavour library plugins <&3; do
        found=$((found + 1))
        if [[ $action == uninstall ]]; then
            uninstall_from "$plugins"
        elif [[ $flavour == unknown-* ]]; then
            say "left MeshLab ${flavour#unknown-} in $library as it is: no flavour fits it"
        else
            ensure_system_packages
            install_into "$flavour" "$plugins"
        fi
    done 3< <(python3 -I "$root/scripts/devseg/installations.py")
    ((found)) || die "found no MeshLab; install Debian's package meshlab, or set" \
        "DEVSEG_MESHLAB_DIR to the folder of its programs"
}

set -euo pipefail
main "$@"
