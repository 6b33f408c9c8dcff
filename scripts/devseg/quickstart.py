"""The last step of scripts/quickstart.sh: `devseg run` with a sample mesh and a folder to start."""

from __future__ import annotations

import argparse
import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path

from devseg.cli import guarded, run_command
from devseg.run_options import add_run_options

# Plush size: the sample's own unit means nothing.
SAMPLE_HEIGHT_MM = 200.0


def sample_mesh() -> Path:
    """The Stanford bunny that ships inside the pymeshlab wheel."""
    package = importlib.util.find_spec("pymeshlab")
    if package is None or not package.submodule_search_locations:
        return Path("pymeshlab is not installed")
    return Path(package.submodule_search_locations[0], "tests", "sample_meshes", "bunny.obj")


def main(argv: Sequence[str] | None = None) -> int:
    """As `devseg run`, but INPUT and -o may be left out."""
    parser = argparse.ArgumentParser(prog="quickstart.sh")
    parser.add_argument("input", nargs="*", type=Path, metavar="MESH")
    parser.add_argument("-o", "--out", type=Path, default=Path("out"), metavar="DIR")
    add_run_options(parser)
    args = parser.parse_args(argv)
    if not args.input:
        args.input = [sample_mesh()]
        if args.mm_per_unit is None and args.height_mm is None:
            args.height_mm = SAMPLE_HEIGHT_MM
    return guarded(lambda: run_command(args, parser))


if __name__ == "__main__":
    sys.exit(main())
