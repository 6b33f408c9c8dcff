#!/usr/bin/env bash
# Segments, flattens and exports a mesh, doing all the set-up that this needs first.
#   scripts/quickstart.sh [MESH] [-o DIR] [any option of "devseg run"]
set -euo pipefail

for argument in "$@"; do
    if [[ $argument == -h || $argument == --help ]]; then
        sed -n '2,3s/^# //p' "${BASH_SOURCE[0]}"
        exit
    fi
done
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# In a subshell: the set-up changes directory, MESH is relative to the caller's.
(
    # shellcheck source=scripts/setup.sh
    source "$here/setup.sh"
    build_targets=(filter_devseg io_pattern) # a pattern needs no tests, which take as long
    devseg_setup
)
exec "$here/../.venv/bin/python" -m devseg.quickstart "$@"
