"""Writes what is generated from the filter declarations: docs/filters.md and scripts/mlx.

.venv/bin/python scripts/reference.py           writes the files that have changed
.venv/bin/python scripts/reference.py --check   fails where a file is not up to date
"""

from __future__ import annotations

import argparse
import html
import json
import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

ROOT = Path(__file__).resolve().parents[1]
DESCRIBE = ROOT / "build" / "release" / "tests" / "devseg_describe_filters"
MLX = Path("scripts") / "mlx"
# One file for each host, written by the tests (tests/python/hosts.py).
RECORDS = ROOT / "build" / "host-runs"
HOSTS = {
    "pymeshlab-2025.07": "pymeshlab 2025.7",
    "pymeshlab-2022.02": "pymeshlab 2022.2",
    "meshlabserver-2020.09": "meshlabserver 2020.09",
    "window-meshlab-2020.09": "MeshLab 2020.09",
    "window-meshlab-2025.07": "MeshLab 2025.07",
}

SEGMENTATION = re.compile(r"compute_segmentation_(\w+)_per_face")
# What most filters work on is made by these.
PREPARATION = ("Segmentation: D-Charts", "Charts: Flatten")
AFTER_SEGMENTATION = ("Charts: Flatten", "Pattern: Export")
# Methods whose charts are deformed first.
DEFORMED = ("papercraft",)
DEFORMATION = "Charts: Deform to Exact Developability"
# The bits of Writes in devseg/filters/filter.h.
WRITES = {
    1: "face attributes `chart_id` and `seam_edges`, edge selection",
    2: "face quality",
    4: "face colours",
    8: "wedge texture coordinates",
    16: "a new layer",
    32: "coordinates of the vertices",
}
WRITES_LAYER = 16
RICH_TYPES = {
    "boolean": "RichBool",
    "integer": "RichInt",
    "real": "RichFloat",
    "choice": "RichEnum",
    "text": "RichString",
    "output file": "RichSaveFile",
}

INTRODUCTION = """# Filters

Written by `scripts/reference.py` from the declarations of the filters; do not edit.

The names are the same in every host: the menu name is what MeshLab's search and `.mlx` scripts
use, the Python name is for `MeshSet.apply_filter`. [hosts.md](hosts.md) says how each host is used.

| filter | Python |
|---|---|
"""


def declarations() -> list[dict[str, Any]]:
    """The filter table, as the plugins declare it."""
    if not DESCRIBE.is_file():
        raise SystemExit(f"{DESCRIBE.relative_to(ROOT)} is not built; run scripts/setup.sh")
    done = subprocess.run([DESCRIBE], capture_output=True, text=True, check=True)
    table = json.loads(done.stdout)
    for filter_ in table:
        for parameter in filter_["parameters"]:
            if parameter["kind"] == "real":
                parameter["default"] = float(parameter["default"])
    return table


def makes_layer(filter_: dict[str, Any]) -> bool:
    """Whether the filter leaves a mesh of its own."""
    return bool(filter_["writes"] & WRITES_LAYER)


def written_default(parameter: dict[str, Any]) -> str:
    """The default as MeshLab's scripts write it."""
    value = parameter["default"]
    if parameter["kind"] == "boolean":
        return "true" if value else "false"
    return f"{value:.6g}" if parameter["kind"] == "real" else str(value)


def markdown(text: str) -> str:
    """Help text, which is HTML with few tags, as Markdown."""
    text = re.sub(r"<(/?)b>", "**", text)
    text = re.sub(r"<(/?)i>", "*", text)
    paragraphs = [part.strip() for part in re.split(r"<br ?/?>", text)]
    return html.unescape("  \n".join(part for part in paragraphs if part))


def filters_page(table: list[dict[str, Any]]) -> str:
    """The reference of all filters."""
    page = INTRODUCTION
    for filter_ in table:
        anchor = re.sub(r"[^a-z0-9 -]", "", filter_["menu_name"].lower()).replace(" ", "-")
        page += f"| [{filter_['menu_name']}](#{anchor}) | `{filter_['python_name']}` |\n"
    return page + "".join(_filter_section(filter_) for filter_ in table)


def _filter_section(filter_: dict[str, Any]) -> str:
    writes = [what for bit, what in WRITES.items() if filter_["writes"] & bit]
    lines = [
        f"\n## {filter_['menu_name']}\n",
        f"`{filter_['python_name']}` · menu *Filters, {filter_['menu']}*\n",
        markdown(filter_["help"]) + "\n",
        f"Writes: {', '.join(writes) or 'nothing'}."
        + (" Needs wedge texture coordinates." if filter_["needs_uv"] else ""),
    ]
    if filter_["parameters"]:
        lines += ["\n| parameter | default | range | meaning |", "|---|---|---|---|"]
        lines += [_parameter_row(parameter) for parameter in filter_["parameters"]]
    if filter_["results"]:
        lines += ["\n| result | meaning |", "|---|---|"]
        lines += [_row(f"`{r['name']}`", r["meaning"]) for r in filter_["results"]]
    return "\n".join(lines) + "\n"


def _parameter_row(parameter: dict[str, Any]) -> str:
    default = written_default(parameter)
    limits = f"{parameter['minimum']:.9g} to {parameter['maximum']:.9g}"
    if parameter["kind"] == "choice":
        default = parameter["choices"][parameter["default"]]
        limits = ", ".join(parameter["choices"])
    elif parameter["kind"] == "boolean":
        limits = "true, false"
    elif parameter["kind"] in ("text", "output file"):
        limits = parameter["kind"]
    meaning = f"{parameter['label']}. {markdown(parameter['help'])}".replace("  \n", " ")
    return _row(f"`{parameter['name']}`", default, limits, meaning)


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def mlx_scripts(table: list[dict[str, Any]]) -> dict[str, str]:
    """File names and texts of one script for each segmentation method."""
    scripts = {}
    by_name = {filter_["menu_name"]: filter_ for filter_ in table}
    for filter_ in table:
        method = SEGMENTATION.fullmatch(filter_["python_name"])
        if method:
            after = (
                (DEFORMATION, *AFTER_SEGMENTATION) if method[1] in DEFORMED else AFTER_SEGMENTATION
            )
            steps = [filter_, *(by_name[name] for name in after if name in by_name)]
            scripts[f"{method[1]}.mlx"] = mlx_script(steps)
    return scripts


def mlx_script(steps: Iterable[dict[str, Any]]) -> str:
    """A filter script of these declarations with their defaults."""
    text = "".join(mlx_filter(step) for step in steps)
    return f"<!DOCTYPE FilterScript>\n<FilterScript>\n{text}</FilterScript>\n"


def mlx_attributes(parameter: dict[str, Any]) -> dict[str, str]:
    """A parameter with its default, as MeshLab's scripts have it."""
    attributes = {
        "type": RICH_TYPES[parameter["kind"]],
        "name": parameter["name"],
        "value": written_default(parameter),
        "description": parameter["label"],
    }
    if parameter["kind"] == "choice":
        attributes["enum_cardinality"] = str(len(parameter["choices"]))
        for number, choice in enumerate(parameter["choices"]):
            attributes[f"enum_val{number}"] = choice
    return attributes


def mlx_filter(filter_: dict[str, Any]) -> str:
    """A step with every parameter: meshlabserver aborts where one of them is missing."""
    lines = [f" <filter name={quoteattr(filter_['menu_name'])}>"]
    for parameter in filter_["parameters"]:
        written = " ".join(f"{k}={quoteattr(v)}" for k, v in mlx_attributes(parameter).items())
        lines.append(f"  <Param {written}/>")
    return "\n".join([*lines, " </filter>"]) + "\n"


def generated_files() -> dict[Path, str]:
    """All generated files, relative to the checkout, and their texts."""
    table = declarations()
    files = {Path("docs") / "filters.md": filters_page(table)}
    files |= {MLX / name: text for name, text in mlx_scripts(table).items()}
    return files


def hosts_table(table: list[dict[str, Any]]) -> str:
    """What the tests have run, in which host."""
    runs = [
        json.loads(file.read_text()) if (file := RECORDS / f"{host}.json").is_file() else {}
        for host in HOSTS
    ]
    lines = [_row("", *HOSTS.values()), _row("---", *("---" for _ in HOSTS))]
    for name in [*(filter_["menu_name"] for filter_ in table), "Saving as SVG"]:
        lines.append(_row(name, *(run.get(name, "not run") for run in runs)))
    return "\n".join(lines)


def write_hosts_table() -> None:
    """Replaces the table in docs/hosts.md."""
    page = ROOT / "docs" / "hosts.md"
    before, rest = page.read_text().split("<!-- what was run -->\n")
    after = rest.split("<!-- end -->")[1]
    table = hosts_table(declarations())
    page.write_text(f"{before}<!-- what was run -->\n{table}\n<!-- end -->{after}")


def main() -> int:
    """Writes or checks; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("--hosts", action="store_true", help="update the table of docs/hosts.md")
    arguments = parser.parse_args()
    if arguments.hosts:
        write_hosts_table()
        return 0
    check = arguments.check
    files = generated_files()
    left_over = {path.relative_to(ROOT) for path in (ROOT / MLX).glob("*.mlx")} - files.keys()
    stale = [
        path
        for path, text in files.items()
        if not (ROOT / path).is_file() or (ROOT / path).read_text() != text
    ]
    for path in [*stale, *sorted(left_over)]:
        print(f"{path}: {'not up to date' if check else 'written'}")
    if check:
        return 1 if stale or left_over else 0
    for path in stale:
        (ROOT / path).parent.mkdir(parents=True, exist_ok=True)
        (ROOT / path).write_text(files[path])
    for path in left_over:
        (ROOT / path).unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
