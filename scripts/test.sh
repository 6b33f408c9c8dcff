#!/usr/bin/env bash
# All tests: unit tests (ctest), linter and formatter, then pytest on the real host, whose closing
# line ends the output. Fails if any of them failed.
set -euo pipefail

# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
devseg_setup
cd "$root"

failed=()
check() {
    local what=$1
    shift
    printf '== %s\n' "$what"
    "$@" </dev/null || failed+=("$what")
}

check ctest ctest --preset release
check "ruff check" .venv/bin/ruff check scripts tests
check "ruff format" .venv/bin/ruff format --check scripts tests
if ((${#failed[@]})); then
    printf 'devseg: failed so far: %s\n' "${failed[*]}"
fi
check pytest .venv/bin/python -m pytest tests/python
((${#failed[@]} == 0))
