"""`devseg info`: what is installed here and whether it works together."""

from __future__ import annotations

from pathlib import Path

from devseg.errors import DevsegError
from devseg.installations import Installation, find_installations, plugin_flavour
from devseg.pipeline import versions
from devseg.plugins import PLUGIN_FILES, load_plugins, plugin_paths

INSTALL = "scripts/install_plugins.sh"


def info() -> str:
    """A report of several lines; a part that is missing is named, not an error."""
    rows = [(name, version) for name, version in versions().items()]
    try:
        rows += [("plugin", f"{path} ({plugin_flavour(path)})") for path in plugin_paths()]
        rows += [("filter", name) for name in load_plugins()]
    except DevsegError as error:
        rows.append(("plugins", f"not usable: {error}"))
    hosts = find_installations()
    rows += [("host", line) for host in hosts for line in host_lines(host)]
    if all(host.plugins is None for host in hosts):
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
    advice = "run scripts/quickstart.sh" if host.plugins is None else f"run {INSTALL}"
    if flavours == {None}:
        return f"the plugins are not installed; {advice}"
    found = " and ".join(sorted(flavour or "none" for flavour in flavours))
    return f"the plugins do not fit: expected {host.flavour}, found {found}; {advice}"
