"""`devseg info`: what is installed here and whether it works together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from devseg.errors import DevsegError
from devseg.installations import Installation, find_installations, plugin_flavour
from devseg.pipeline import versions
from devseg.plugins import PLUGIN_FILES, load_plugins, plugin_paths
from devseg.requirements import repair

INSTALL = "scripts/install_plugins.sh"


def info() -> dict[str, Any]:
    """What is installed; a part that is missing is named, not an error."""
    found: dict[str, Any] = {"versions": versions(), "plugins": [], "filters": [], "error": None}
    try:
        found["plugins"] = [
            {"file": str(path), "flavour": plugin_flavour(path)} for path in plugin_paths()
        ]
        found["filters"] = load_plugins()
    except DevsegError as error:
        found["error"] = str(error)
    found["hosts"] = [
        {
            "kind": "pymeshlab" if host.plugins is None else "MeshLab",
            "version": host.version,
            "flavour": host.flavour,
            "library": str(host.library),
            "programs": [str(path) for path in host.programs],
            "about": host_lines(host),
        }
        for host in find_installations()
    ]
    return found


def info_text(found: dict[str, Any]) -> str:
    """The same in several lines."""
    rows = list(found["versions"].items())
    rows += [("plugin", f"{one['file']} ({one['flavour']})") for one in found["plugins"]]
    rows += [("filter", name) for name in found["filters"]]
    if found["error"] is not None:
        rows.append(("plugins", f"not usable: {found['error']}"))
    rows += [("host", line) for host in found["hosts"] for line in host["about"]]
    if all(host["kind"] == "pymeshlab" for host in found["hosts"]):
        rows.append(("host", "no MeshLab with a window or meshlabserver found"))
    width = max(len(label) for label, _ in rows)
    return "\n".join(f"{label:<{width}}  {value}" for label, value in rows)


def host_lines(host: Installation) -> list[str]:
    """What a host is, and whether our plugins fit it."""
    if host.plugins is None:
        return [
            f"pymeshlab {host.version} in this Python environment: {_fit(host, _own_plugins())}"
        ]
    programs = ", ".join(str(path) for path in host.programs) or str(host.library.parent)
    installed = [host.plugins / name for name in PLUGIN_FILES]
    return [f"MeshLab {host.version}, {programs}: {_fit(host, installed)}"]


def _own_plugins() -> list[Path]:
    try:
        return plugin_paths()
    except DevsegError:
        return []


def _fit(host: Installation, plugins: list[Path]) -> str:
    if host.flavour is None:
        return "no flavour of the plugins fits this version"
    flavours = {plugin_flavour(plugin) for plugin in plugins} or {None}
    if flavours == {host.flavour}:
        return f"the plugins fit ({host.flavour})"
    advice = repair() if host.plugins is None else f"run {INSTALL}"
    if flavours == {None}:
        return f"the plugins are not installed; {advice}"
    found = " and ".join(sorted(flavour or "none" for flavour in flavours))
    return f"the plugins do not fit: expected {host.flavour}, found {found}; {advice}"
