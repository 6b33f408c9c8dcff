"""The hosts on this machine, as the tests use them, and a record of what was run where."""

from __future__ import annotations

import functools
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from html import unescape
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import devseg
from conftest import ROOT
from devseg import host
from devseg.installations import Installation, find_installations
from devseg.plugins import PLUGIN_FILES

sys.path.insert(0, str(ROOT / "scripts"))

import reference

CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "devseg"
# pymeshlab may keep a pointer to the log of a MeshSet and use it for later ones.
_alive: list[Any] = []
OLD_PYTHON = CACHE / "pymeshlab-2022.2" / "bin" / "python"


def missing(what: str) -> None:
    """Skips; where scripts/test.sh has set everything up, a part that is missing is a failure."""
    if os.environ.get("DEVSEG_HOST_TESTS") == "required":
        pytest.fail(f"{what}, and DEVSEG_HOST_TESTS=required")
    pytest.skip(what)


def flavour_plugins(flavour: str) -> list[Path]:
    """The plugin files of a flavour; skips where they are not built."""
    paths = [ROOT / "build" / flavour / "plugins" / name for name in PLUGIN_FILES]
    if not all(path.is_file() for path in paths):
        missing(f"the plugins are not built; run scripts/build_host.sh {flavour}")
    return paths


def declarations() -> list[dict[str, Any]]:
    return reference.declarations()


def record(host: str, filter_name: str, what: str) -> None:
    """Remembers for docs/hosts.md what has been run; called after it has worked."""
    assert host in reference.HOSTS
    reference.RECORDS.mkdir(parents=True, exist_ok=True)
    file = reference.RECORDS / f"{host}.json"
    known = json.loads(file.read_text()) if file.is_file() else {}
    file.write_text(json.dumps({**known, filter_name: what}, indent=1) + "\n")


def reported_script(file: Path) -> dict[str, list[dict[str, str]]]:
    """The filters of an .mlx file that a host has saved, and their parameters."""
    root = ElementTree.parse(file).getroot()
    return {
        step.get("name", ""): [dict(param.attrib) for param in step.iter("Param")]
        for step in root.iter("filter")
    }


def declared_script(filter_: dict[str, Any]) -> list[dict[str, str]]:
    """The same for a declaration."""
    return [
        {**reference.mlx_attributes(parameter), "tooltip": parameter["help"]}
        for parameter in filter_["parameters"]
    ]


def without_extensions(parameters: list[dict[str, str]]) -> list[dict[str, str]]:
    """What a file dialog filters by is no part of a declaration."""
    return [{k: v for k, v in p.items() if k != "ext"} for p in parameters]


@dataclass(frozen=True)
class PrivateMeshLab:
    """A MeshLab that loads our plugins, without touching the installed one."""

    folder: Path
    installation: Installation

    @staticmethod
    def make(folder: Path, flavour: str) -> PrivateMeshLab:
        """Puts programs, plugins and ours together; MeshLab looks for plugins beside itself."""
        ours = flavour_plugins(flavour)
        found = [host for host in find_installations() if host.flavour == flavour]
        if not found:
            missing(f"no {flavour} on this machine")
        host = found[0]
        assert host.plugins is not None
        (folder / "plugins").mkdir(parents=True)
        for program in host.programs:
            shutil.copy(program, folder)
        for plugin in [*host.plugins.glob("*.so"), *ours]:
            link = folder / "plugins" / plugin.name
            link.unlink(missing_ok=True)
            link.symlink_to(plugin)
        return PrivateMeshLab(folder, host)

    def environment(self) -> dict[str, str]:
        """Settings of its own, and the library of the installed one."""
        home = self.folder / "home"
        (home / ".config").mkdir(parents=True, exist_ok=True)
        home.chmod(0o700)
        kept = {name: value for name, value in os.environ.items() if name in ("PATH", "LANG")}
        return {
            **kept,
            "HOME": str(home),
            "XDG_CONFIG_HOME": str(home / ".config"),
            "XDG_RUNTIME_DIR": str(home),
            "LD_LIBRARY_PATH": str(self.installation.library.parent),
        }

    def serve(self, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
        """Runs meshlabserver."""
        if not (self.folder / "meshlabserver").is_file() or shutil.which("xvfb-run") is None:
            missing("no meshlabserver or no xvfb-run on this machine")
        return subprocess.run(
            ["xvfb-run", "-a", str(self.folder / "meshlabserver"), *map(str, arguments)],
            env=self.environment(),
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=300,
        )


def server_report(server: PrivateMeshLab) -> dict[str, dict[str, Any]]:
    """What meshlabserver says of each filter: its help, and kind, label and help of parameters."""
    file = server.folder / "filters.txt"
    done = server.serve("-d", file)
    assert done.returncode == 0, done.stdout
    sections = re.split(r"\n\\section f\d+ ", file.read_text())[1:]
    row = re.compile(r"<TR><TD> \\c (\w+)  </TD> <TD> (.*?) </TD> <TD><i> (.*?) -- </i></TD> </TR>")
    report = {}
    for section in sections:
        name, help_text = section.split(" \n\n", 1)
        report[name] = {
            "help": help_text.split("\n<H2> Parameters", 1)[0],
            "parameters": [
                {"kind": kind, "label": label, "help": unescape(help_)}
                for kind, label, help_ in row.findall(section)
            ],
        }
    return report


def prepared(filter_: dict[str, Any]) -> list[dict[str, Any]]:
    """The filter behind those that make what it may need: charts and texture coordinates."""
    by_name = {step["menu_name"]: step for step in declarations()}
    return [*(by_name[name] for name in reference.PREPARATION), filter_]


@functools.cache
def numbers(mesh: Path) -> dict[str, Any]:
    """What filters on a selection are told instead, for a mesh that was prepared.

    All of its pieces, a seam, and a vertex inside of a chart; even where that costs stretch.
    """
    devseg.load_plugins()
    meshset = host.pymeshlab().MeshSet()
    _alive.append(meshset)
    with host.captured():
        meshset.load_new_mesh(str(mesh))
        for step in prepared({})[:2]:
            made = meshset.apply_filter(step["python_name"])
    prepared_mesh = meshset.current_mesh()
    seams = prepared_mesh.face_custom_scalar_attribute_array("seam_edges")
    faces = prepared_mesh.face_matrix()
    outside = np.unique(faces[seams > 0])
    inside = np.setdiff1d(np.arange(prepared_mesh.vertex_number()), outside)
    pieces = ",".join(str(n + 1) for n in range(made["charts_number"]))
    return {"pieces": pieces, "seams": "1", "vertices": str(inside[0]), "force": True}


def sample(filter_: dict[str, Any], plain: Path, folder: Path) -> Path:
    """The mesh to run a filter on: a bunny with a texture where that is needed, else `plain`."""
    file = folder / "textured.ply"
    if not filter_["needs_texture"]:
        return plain
    if not file.is_file():
        meshset = host.pymeshlab().MeshSet()
        _alive.append(meshset)
        samples = Path(host.pymeshlab().__file__).parent / "tests" / "sample_meshes"
        with host.captured():
            meshset.load_new_mesh(str(samples / "bunny10k_textured.obj"))
            meshset.save_current_mesh(str(file))
    return file


def told(filter_: dict[str, Any], file: Path, mesh: Path) -> dict[str, Any]:
    """The values of parameters that have no default which works: files and numbers."""
    chosen = numbers(mesh) if filter_["needs_selection"] else {}
    return {
        p["name"]: str(file) if p["kind"] == "output file" else chosen[p["name"]]
        for p in filter_["parameters"]
        if p["kind"] == "output file" or p["name"] in chosen
    }


def with_values(steps: list[dict[str, Any]], file: Path, mesh: Path) -> list[dict[str, Any]]:
    """The same steps with what they must be told."""
    return [
        {
            **step,
            "parameters": [
                {**p, "default": told(step, file, mesh).get(p["name"], p["default"])}
                for p in step["parameters"]
            ],
        }
        for step in steps
    ]
