"""Finding the two plugins and loading them into the running pymeshlab."""

from __future__ import annotations

import os
from pathlib import Path

from devseg import host
from devseg.errors import DevsegError, host_message
from devseg.requirements import loading_advice, repair

PLUGIN_FILES = ("libfilter_devseg.so", "libio_pattern.so")

_loaded: list[str] = []


def search_directories() -> list[Path]:
    """Where the plugins are looked for, in this order."""
    package = Path(__file__).resolve().parent
    directories = [package / "plugins", package.parents[1] / "build" / "release" / "plugins"]
    chosen = os.environ.get("DEVSEG_PLUGIN_DIR")
    # A directory that was asked for and does not serve is an error, not a reason to guess.
    return [Path(chosen)] if chosen else directories


def plugin_paths() -> list[Path]:
    """The two plugin files.

    Raises:
        DevsegError: where they are not built yet.
    """
    directories = search_directories()
    for directory in directories:
        paths = [directory / name for name in PLUGIN_FILES]
        if all(path.is_file() for path in paths):
            return paths
    looked = ", ".join(str(directory) for directory in directories)
    raise DevsegError(
        f"expected the plugins {' and '.join(PLUGIN_FILES)} in one of: {looked}; "
        f"found none; {repair()}"
    )


def load_plugins() -> list[str]:
    """Loads both plugins into pymeshlab, once, and makes every filter a method of MeshSet.

    Returns:
        The names of the filters that the plugins provide.

    Raises:
        DevsegError: where a plugin is missing or the host refuses it.
    """
    if _loaded:
        return list(_loaded)
    pymeshlab = host.pymeshlab()
    for path in plugin_paths():
        try:
            with host.captured():
                pymeshlab.load_plugin(str(path))
        except pymeshlab.PyMeshLabException as error:
            # The caller may have loaded it with pymeshlab.load_plugin: just as good.
            if "already loaded" not in str(error):
                advice = loading_advice(host_message(error))
                raise DevsegError(f"pymeshlab refuses {path}: {advice}") from error
    # pymeshlab has bound the filters of its own plugins and no others.
    new = [name for name in pymeshlab.filter_list() if not hasattr(pymeshlab.MeshSet, name)]
    for name in new:
        setattr(pymeshlab.MeshSet, name, host.filter_method(name))
    _loaded.extend(new)
    return list(new)
