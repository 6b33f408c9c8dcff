"""Asks `auditwheel show` whether a wheel keeps what its name promises.

    python check_tag.py WHEEL PYMESHLAB

Its symbols may be those of the platform in its name. Libraries beside the system's may only be
those that the wheel of pymeshlab in the folder PYMESHLAB brings, loaded before the plugins.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any


def audit(wheel: Path, libraries: Path) -> dict[str, Any]:
    """What auditwheel finds where libraries come from that folder."""
    command = [sys.executable, "-m", "auditwheel", "show", "--json", "--ldpaths", libraries, wheel]
    found = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(found.stdout)


def glibc(platform: str) -> tuple[int, ...]:
    """The version of the C library that a platform stands for."""
    return tuple(map(int, re.fullmatch(r"manylinux_(\d+)_(\d+)_x86_64", platform).groups()))


def problems(wheel: Path, pymeshlab: Path) -> list[str]:
    """What does not fit, a line each."""
    libraries = (pymeshlab / "lib").resolve()
    found = audit(wheel, libraries)
    platform = wheel.stem.rpartition("-")[2]
    lines = []
    if glibc(found["sym_tag"]) > glibc(platform):
        lines.append(f"expected symbols of {platform}, found some of {found['sym_tag']}")
    for name, place in found["external_libs"].items():
        if place is None or not Path(place).resolve().is_relative_to(libraries):
            lines.append(f"expected libraries of the system and of pymeshlab, found {name}")
    return lines


def main() -> int:
    """Prints what does not fit; 1 where something does not."""
    lines = problems(*map(Path, sys.argv[1:]))
    print("\n".join(lines) or "auditwheel: the name of the wheel is true")
    return int(bool(lines))


if __name__ == "__main__":
    sys.exit(main())
