"""MeshLab installations on this machine, and which plugins fit them.

As a program it prints one line for each MeshLab, for the shell scripts that run it by any Python:
flavour, folder of the library and folder of the plugins, separated by tabs.
"""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

LIBRARY = "libmeshlab-common.so"
FLAVOURS = (
    "pymeshlab-2025.07",
    "pymeshlab-2022.02",
    "meshlab-2025.07",
    "meshlab-2022.02",
    "meshlab-2020.09",
)


@dataclass(frozen=True)
class Installation:
    """A MeshLab, or the one inside pymeshlab.

    Attributes:
        library: its libmeshlab-common.so.
        version: as the library says it; a trailing d means double precision.
        plugins: the folder that it loads plugins from; None for pymeshlab, which is told the files.
    """

    library: Path
    version: str
    plugins: Path | None

    @property
    def flavour(self) -> str | None:
        """The flavour of our plugins that fits, None where none does."""
        kind = "pymeshlab" if self.version.endswith("d") else "meshlab"
        name = f"{kind}-{self.version.rstrip('d')}"
        return name if name in FLAVOURS else None

    @property
    def programs(self) -> list[Path]:
        """The programs that use this library, where they are at their usual places."""
        return _programs(self.library)


def find_installations() -> list[Installation]:
    """The pymeshlab of this Python and every MeshLab at a usual place, each once."""
    found = []
    wheel = _wheel_library()
    if wheel is not None:
        found.append(Installation(wheel, library_version(wheel), None))
    seen = set()
    for library in _libraries():
        real = library.resolve()
        plugins = library.parent / "plugins"
        if real in seen or not plugins.is_dir():
            continue
        seen.add(real)
        found.append(Installation(library, library_version(library), plugins))
    return found


def library_version(library: Path) -> str:
    """The version that MeshLab's library was built as: 2020.09, 2025.07d."""
    version = re.compile(rb"20\d\d\.\d\dd?")
    found = version.search(library.read_bytes())
    if found is None:
        # Compilers may take such a short text apart. Versions as new as that answer this without
        # opening a window.
        for program in _programs(library):
            with contextlib.suppress(OSError, subprocess.TimeoutExpired):
                asked = subprocess.run([program, "--version"], capture_output=True, timeout=10)
                found = found or version.search(asked.stdout)
    return found[0].decode() if found else "unknown"


def _programs(library: Path) -> list[Path]:
    # From usr/lib/<machine>/meshlab upwards: the nearest folder with programs is meant.
    for parent in library.parents:
        for folder in (parent, parent / "bin"):
            found = [folder / name for name in ("meshlab", "meshlabserver")]
            found = [path for path in found if path.is_file()]
            if found:
                return found
    return []


def plugin_flavour(plugin: Path) -> str | None:
    """The flavour that a plugin file of this project was built as; None for other files."""
    if not plugin.is_file():
        return None
    found = re.search(rb"devseg-flavour=([\w.-]+)", plugin.read_bytes())
    return found[1].decode() if found else None


def _wheel_library() -> Path | None:
    # Importing it would start half of Qt.
    spec = importlib.util.find_spec("pymeshlab")
    if spec is None or not spec.submodule_search_locations:
        return None
    library = Path(spec.submodule_search_locations[0]) / "lib" / LIBRARY
    return library if library.is_file() else None


def _libraries() -> Iterable[Path]:
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "devseg"
    prefixes = [cache / "meshlab-2025.07-window", Path("/usr"), Path("/usr/local")]
    program = shutil.which("meshlab")
    if program is not None:
        folder = Path(program).resolve().parent
        prefixes = [folder, folder.parent, *prefixes]
    chosen = os.environ.get("DEVSEG_MESHLAB_DIR")
    if chosen:
        # A folder that was asked for and does not serve is no reason to guess.
        prefixes = [Path(chosen)]
    for prefix in prefixes:
        for pattern in ("", "lib/meshlab", "lib/*/meshlab", "usr/lib/meshlab"):
            yield from sorted(prefix.glob(f"{pattern}/{LIBRARY}" if pattern else LIBRARY))


def main() -> None:
    """Prints the MeshLab installations, without pymeshlab's."""
    for host in find_installations():
        if host.plugins is not None:
            flavour = host.flavour or f"unknown-{host.version}"
            print(flavour, host.library.resolve().parent, host.plugins, sep="\t")


if __name__ == "__main__":
    main()
