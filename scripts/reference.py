"""Writes what is generated from the filter declarations.

These are docs/filters.md, docs/materials.md, the tables in the pages of docs/methods and in
README.md, the scripts of scripts/mlx, and the methods of the command line in
scripts/devseg/methods_table.py.

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
METHODS_TABLE = Path("scripts") / "devseg" / "methods_table.py"
METHOD_PAGES = Path("docs") / "methods"
# A page asks for the tables of a filter by a line such as <!-- parameters of PYTHON_NAME -->; they
# stand between it and the next END.
END = "<!-- end -->\n"
TABLES = re.compile(r"(?<=^<!-- parameters of )(\w+)( -->\n)(.*?)(?=^<!-- end -->\n)", re.M | re.S)
RUNS = "<!-- what was run -->\n"
FILTERS = "<!-- filters -->\n"
METHODS = "<!-- methods -->\n"
MATERIALS = "<!-- materials -->\n"
STAGES = "<!-- stages -->\n"
# Larger bounds of parameters are no bounds.
UNBOUNDED = 1e6
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
# First where the method says that its charts are deformed.
DEFORMATION = "Charts: Deform to Exact Developability"
# The bits of Writes in devseg/declare/filter.h.
WRITES = {
    1: "face attributes `chart_id` and `seam_edges`, edge selection",
    2: "face quality",
    4: "face colours",
    8: "wedge texture coordinates",
    16: "a new layer",
    32: "coordinates of the vertices",
    64: "split faces with all their attributes",
    128: "one texture image",
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

The names are the same in every host. MeshLab's search and `.mlx` scripts use the menu name;
`MeshSet.apply_filter` takes the Python name. [hosts.md](hosts.md) says how each host is used.

| filter | Python | parameters and results |
|---|---|---|
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


def materials_page(page: str) -> str:
    """docs/materials.md with the table of materials, as the plugins hold it."""
    done = subprocess.run([DESCRIBE, "materials"], capture_output=True, text=True, check=True)
    table = json.loads(done.stdout)
    shares = ("warp", "weft", "bias", "compression")

    def cell(key: str, value: float | bool) -> str:
        if isinstance(value, bool):
            return "yes" if value else "no"
        return f"{100 * value:g} %" if key in shares else f"{value:g}"

    keys = [value["key"] for value in table["values"]]
    lines = [_row("material", *(f"`{key}`" for key in keys)), _row(*["---"] * (len(keys) + 1))]
    lines += [_row(m["name"], *(cell(key, m[key]) for key in keys)) for m in table["materials"]]
    lines += ["", *(f"- `{value['key']}`: {value['meaning']}" for value in table["values"])]
    sources: dict[str, list[str]] = {}
    for m in table["materials"]:
        sources.setdefault(m["source"], []).append(m["name"])
    lines += ["", "Where the values are from:", ""]
    lines += [f"- {', '.join(names)}: {source}." for source, names in sources.items()]
    return replaced(page, MATERIALS, "\n".join(lines))


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


def filters_page(table: list[dict[str, Any]], pages: dict[str, Path]) -> str:
    """The index of all filters, and the reference of those without a page of their own."""
    page = INTRODUCTION
    for filter_ in table:
        name, python_name = filter_["menu_name"], filter_["python_name"]
        anchor = re.sub(r"[^a-z0-9 -]", "", name.lower()).replace(" ", "-")
        place = f"[below](#{anchor})"
        if python_name in pages:
            path = pages[python_name].relative_to("docs").as_posix()
            place = f"[{path}]({path})"
        page += f"| {name} | `{python_name}` | {place} |\n"
    for filter_ in table:
        if filter_["python_name"] not in pages:
            page += f"\n## {filter_['menu_name']}\n\n{markdown(filter_['help'])}\n\n"
            page += filter_tables(filter_)
    return page


def method_pages() -> dict[Path, str]:
    """The pages that ask for tables of filters, relative to the checkout, as they are."""
    paths = sorted((ROOT / METHOD_PAGES).glob("*.md"))
    texts = {path.relative_to(ROOT): path.read_text() for path in paths}
    return {path: text for path, text in texts.items() if TABLES.search(text)}


def page_of_filter(pages: dict[Path, str]) -> dict[str, Path]:
    """The page that has the tables of a filter, by its Python name."""
    found: dict[str, Path] = {}
    for path, text in pages.items():
        for name, _, _ in TABLES.findall(text):
            if name in found:
                raise SystemExit(f"{path}: {name} has its tables in {found[name]} already")
            found[name] = path
    return found


def filled(path: Path, text: str, table: list[dict[str, Any]]) -> str:
    """The page with its tables up to date."""
    by_name = {filter_["python_name"]: filter_ for filter_ in table}

    def tables(match: re.Match[str]) -> str:
        if match[1] not in by_name:
            raise SystemExit(f"{path}: no filter is called {match[1]}")
        return f"{match[1]}{match[2]}\n{filter_tables(by_name[match[1]])}\n"

    return TABLES.sub(tables, text)


def replaced(text: str, start: str, block: str) -> str:
    """The text with another block between the line `start` and the next END."""
    before, rest = text.split(start)
    return f"{before}{start}{block}\n{END}{rest.split(END, maxsplit=1)[1]}"


def methods_index(text: str, table: list[dict[str, Any]], pages: dict[Path, str]) -> str:
    """docs/methods/README.md: a row for each page, with its title and the line below it."""
    by_name = {filter_["python_name"]: filter_["menu_name"] for filter_ in table}
    order = list(by_name)
    lines: dict[str, list[str]] = {METHODS: [], STAGES: []}
    names = {path: [name for name, _, _ in TABLES.findall(page)] for path, page in pages.items()}
    for path in sorted(pages, key=lambda path: order.index(names[path][0])):
        title, lead = pages[path].split("\n\n", maxsplit=2)[:2]
        row = _row(
            f"[{title.removeprefix('# ')}]({path.name})",
            ", ".join(by_name[name] for name in names[path]),
            lead.strip("*"),
        )
        lines[METHODS if SEGMENTATION.fullmatch(names[path][0]) else STAGES].append(row)
    for start, rows in lines.items():
        head = ["| page | filters | what for |", "|---|---|---|"]
        text = replaced(text, start, "\n".join([*head, *rows]))
    return text


def readme_table(text: str, table: list[dict[str, Any]]) -> str:
    """README.md with a row for each filter; what it does is kept as it was written there."""
    rows = [line.strip("| ").split(" | ") for line in text.split(FILTERS)[1].splitlines()]
    written = {row[1].strip("`"): row[2] for row in rows if len(row) == 3}
    groups = ["Segmentation", "Charts", "Texture", "Pattern"]
    measures = "get_"

    def rank(filter_: dict[str, Any]) -> tuple[bool, int]:
        group = groups.index(filter_["menu_name"].split(":")[0])
        return filter_["python_name"].startswith(measures), group

    lines = ["| menu | Python | what it does |", "|---|---|---|"]
    for filter_ in sorted(table, key=rank):
        name = filter_["python_name"]
        what = written.get(name) or first_sentence(help_text(filter_))[0].rstrip(".")
        lines.append(_row(filter_["menu_name"], f"`{name}`", what))
    return replaced(text, FILTERS, "\n".join(lines))


def filter_tables(filter_: dict[str, Any]) -> str:
    """Names, what is written, parameters and results of a filter."""
    writes = [what for bit, what in WRITES.items() if filter_["writes"] & bit]
    lines = [
        f"`{filter_['python_name']}` · menu *Filters, {filter_['menu']}*  ",
        f"Writes: {', '.join(writes) or 'nothing'}."
        + (" Needs wedge texture coordinates." if filter_["needs_uv"] else ""),
    ]
    if filter_["parameters"]:
        lines += ["", "| parameter | default | range | meaning |", "|---|---|---|---|"]
        lines += [_parameter_row(parameter) for parameter in filter_["parameters"]]
        more = [(p["name"], first_sentence(help_text(p))[1]) for p in filter_["parameters"]]
        if any(rest for _, rest in more):
            lines += ["", *(f"- `{name}`: {rest}" for name, rest in more if rest)]
    if filter_["results"]:
        lines += ["", "| result | meaning |", "|---|---|"]
        lines += [_row(f"`{r['name']}`", r["meaning"]) for r in filter_["results"]]
    return "\n".join(lines) + "\n"


def help_text(described: dict[str, Any]) -> str:
    """The help of a parameter or a filter on one line."""
    return markdown(described["help"]).replace("  \n", " ")


def first_sentence(text: str) -> tuple[str, str]:
    """The first sentence, for a table, and the rest. A sentence ends before a capital."""
    parts = re.split(r"(?<=[a-z0-9)]\.) (?=[A-Z0-9])", text, maxsplit=1)
    return parts[0], parts[1] if len(parts) > 1 else ""


def _parameter_row(parameter: dict[str, Any]) -> str:
    default = written_default(parameter)
    limits = f"{parameter['minimum']:.9g} to {parameter['maximum']:.9g}"
    if parameter["maximum"] >= UNBOUNDED:
        limits = f"≥ {parameter['minimum']:.9g}"
    if parameter["kind"] == "choice":
        default = parameter["choices"][parameter["default"]]
        limits = ", ".join(parameter["choices"])
    elif parameter["kind"] == "boolean":
        limits = "true, false"
    elif parameter["kind"] in ("text", "output file"):
        limits = parameter["kind"]
    return _row(
        f"`{parameter['name']}`",
        default or "empty",
        limits,
        first_sentence(help_text(parameter))[0],
    )


def _row(*cells: str) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def mlx_scripts(table: list[dict[str, Any]]) -> dict[str, str]:
    """File names and texts of one script for each segmentation method."""
    scripts = {}
    by_name = {filter_["menu_name"]: filter_ for filter_ in table}
    for filter_ in table:
        method = SEGMENTATION.fullmatch(filter_["python_name"])
        if method:
            after = AFTER_SEGMENTATION
            if filter_["command"]["deforms"]:
                after = (DEFORMATION, *after)
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


def methods_table(table: list[dict[str, Any]]) -> str:
    """The module that lists the methods of the command line, as ruff formats it."""
    text = '"""Written by scripts/reference.py from the declarations; do not edit."""\n\n'
    text += "TABLE = {\n"
    for filter_ in table:
        command = filter_["command"]
        if command["name"]:
            row = {
                "filter": filter_["python_name"],
                "parameters": [p["name"] for p in filter_["parameters"]],
                "flatten": command["flatten"],
                "preset": command["preset"] or None,
                "deforms": command["deforms"],
            }
            text += f"    {python(command['name'])}: {{\n"
            for key, value in row.items():
                if value and isinstance(value, list):
                    items = "".join(f"            {python(name)},\n" for name in value)
                    text += f"        {python(key)}: [\n{items}        ],\n"
                else:
                    text += f"        {python(key)}: {python(value)},\n"
            text += "    },\n"
    return text + "}\n"


def python(value: object) -> str:
    """A literal with the quotes that ruff wants."""
    return json.dumps(value) if isinstance(value, str) else repr(value)


def generated_files() -> dict[Path, str]:
    """All generated files, relative to the checkout, and their texts."""
    table = declarations()
    pages = method_pages()
    files = {path: filled(path, text, table) for path, text in pages.items()}
    files[Path("docs") / "filters.md"] = filters_page(table, page_of_filter(pages))
    materials = Path("docs") / "materials.md"
    files[materials] = materials_page((ROOT / materials).read_text())
    index, readme = METHOD_PAGES / "README.md", Path("README.md")
    files[index] = methods_index((ROOT / index).read_text(), table, pages)
    files[readme] = readme_table((ROOT / readme).read_text(), table)
    files |= {MLX / name: text for name, text in mlx_scripts(table).items()}
    files[METHODS_TABLE] = methods_table(table)
    return files


def host_runs() -> dict[str, dict[str, str]]:
    """What the tests have recorded: for each host, what each filter did."""
    return {
        host: json.loads(file.read_text()) if (file := RECORDS / f"{host}.json").is_file() else {}
        for host in HOSTS
    }


def hosts_table(table: list[dict[str, Any]], runs: dict[str, dict[str, str]]) -> str:
    """What the tests have run, in which host."""
    names = [filter_["menu_name"] for filter_ in table]
    lines = [_row("host", "filters", "saving as SVG"), "|---|---|---|"]
    for host, title in HOSTS.items():
        outcomes: dict[str, list[str]] = {}
        for name in names:
            outcomes.setdefault(runs[host].get(name, "not run"), []).append(name)
        cells = [
            f"{what}: {f'all {len(names)}' if who == names else ', '.join(who)}"
            for what, who in outcomes.items()
        ]
        lines.append(_row(title, "; ".join(cells), runs[host].get("Saving as SVG", "not run")))
    return "\n".join(lines)


def write_hosts_table() -> None:
    """Replaces the table in docs/hosts.md."""
    page = ROOT / "docs" / "hosts.md"
    table = hosts_table(declarations(), host_runs())
    page.write_text(replaced(page.read_text(), RUNS, table))


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
