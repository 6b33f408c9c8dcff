"""What is missing where pymeshlab or the plugins cannot be loaded, and what to do, in one line."""

from __future__ import annotations

import ctypes
import os
import re
import sys
from pathlib import Path

from devseg.errors import one_line

# The version that the plugins are compiled for, by its headers and its library.
PYMESHLAB = "2025.7.post1"

# Libraries of the system that pymeshlab's wheel needs and bare containers lack, and the packages of
# Debian and Ubuntu that have them. Our wheel has stand-ins, see scripts/wheel/stand_ins.py.
_PACKAGES = {
    "libGL.so.1": "libgl1",
    "libOpenGL.so.0": "libopengl0",
    "libcom_err.so.2": "libcom-err2",
}
_MISSING_LIBRARY = re.compile(r"(lib[\w.+-]+\.so[\w.]*): cannot open shared object file")
_MISSING_VERSION = re.compile(r"version [`']GLIBC_([\d.]+)' not found")


def repair() -> str:
    """How this installation is made whole again: a checkout, or a wheel."""
    if (Path(__file__).resolve().parents[2] / "scripts" / "quickstart.sh").is_file():
        return "run scripts/quickstart.sh"
    return "pip install --force-reinstall devseg"


def load_stand_ins() -> None:
    """Loads our stand-ins for those libraries that the system lacks.

    Others that need a library find the stand-in by its name, as it is loaded already.
    """
    for library in _PACKAGES:
        name = library.partition(".")[0]
        file = Path(__file__).resolve().parent / "plugins" / f"stand_in_{name}.so"
        if file.is_file():
            try:
                ctypes.CDLL(library)
            except OSError:
                ctypes.CDLL(str(file))


def loading_advice(error: str) -> str:
    """What an error of the system's loader means, or of an import."""
    error = one_line(error)
    version = _MISSING_VERSION.search(error)
    if version:
        return (
            f"expected glibc {version[1]} or later, as Debian 12 and Ubuntu 22.04 have it, found "
            f"{os.confstr('CS_GNU_LIBC_VERSION')}; use a newer system"
        )
    library = _MISSING_LIBRARY.search(error)
    if library and library[1] in _PACKAGES:
        packages = " ".join(_PACKAGES.values())
        return f"pymeshlab needs {library[1]}, which is missing: apt install {packages}"
    return f"{error}; {repair()}"


def version_advice() -> str | None:
    """What to do where another pymeshlab is installed than the plugins are for; None: it fits."""
    found = installed_version("pymeshlab")
    if found is None:
        return f"expected pymeshlab {PYMESHLAB}, found none; pip install pymeshlab=={PYMESHLAB}"
    # Plugins for the version before are built from source, and fit that one.
    if found == PYMESHLAB or found.startswith("2022.2"):
        return None
    return f"expected pymeshlab {PYMESHLAB}, found {found}; pip install pymeshlab=={PYMESHLAB}"


def installed_version(name: str) -> str | None:
    """The version of a package that is installed here; None without it.

    Wheels leave a folder whose name says it, which importlib.metadata takes 20 ms longer to read.
    """
    for folder in sys.path:
        for found in Path(folder).glob(f"{name}-*.dist-info"):
            return found.stem.partition("-")[2]
    import importlib.metadata

    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None
