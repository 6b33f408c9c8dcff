"""`devseg info`: what is installed here and whether it works together."""

from __future__ import annotations

import re
import shutil
import subprocess

from devseg.errors import DevsegError
from devseg.pipeline import versions
from devseg.plugins import load_plugins, plugin_paths, search_directories


def info() -> str:
    """A report of several lines; a part that is missing is named, not an error."""
    rows = [(name, version) for name, version in versions().items()]
    rows.append(("MeshLab headers", _headers_version()))
    try:
        rows += [("plugin", str(path)) for path in plugin_paths()]
        rows += [("filter", name) for name in load_plugins()]
    except DevsegError as error:
        rows.append(("plugins", f"not usable: {error}"))
    rows.append(("host pymeshlab", "this Python environment"))
    rows += [(f"host {name}", _installed(name)) for name in ("meshlab", "meshlabserver")]
    width = max(len(label) for label, _ in rows)
    return "\n".join(f"{label:<{width}}  {value}" for label, value in rows)


def _headers_version() -> str:
    """The version that the plugins of this checkout were compiled against."""
    cache = search_directories()[-1].parent / "CMakeCache.txt"
    if cache.is_file():
        found = re.search(r"^DEVSEG_MESHLAB_VERSION:\w+=(.+)$", cache.read_text(), re.MULTILINE)
        if found:
            return found[1]
    return "unknown (no build folder beside the plugins)"


def _installed(program: str) -> str:
    """Path of a program, with the version of its Debian package: asking itself needs OpenGL."""
    path = shutil.which(program)
    if path is None:
        return "not found on PATH"
    query = shutil.which("dpkg-query")
    if query is None:
        return path
    asked = subprocess.run(
        [query, "-W", "-f=${Version}", "meshlab"], capture_output=True, text=True, check=False
    )
    version = asked.stdout.strip()
    return f"{path} ({version})" if version else path
