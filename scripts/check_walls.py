"""Checks the walls between the rooms of the sources: who may include whom.

.venv/bin/python scripts/check_walls.py           fails with a line for each broken rule
.venv/bin/python scripts/check_walls.py --table   prints what the rooms really include, as rows

A room is a folder that holds sources. The first table of docs/architecture.md has a row for each:
its folder in backticks, what lives there, and the rooms it may include, in backticks, or a dash.
"""

from __future__ import annotations

import argparse
import graphlib
import os
import re
import sys
from collections.abc import Iterator
from itertools import dropwhile, takewhile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TABLE = "docs/architecture.md"
HEAD = ["room", "what lives there", "may include"]
NOTHING = "\N{EN DASH}"
CORE = "filter_devseg/devseg/"
INCLUDE_ROOTS = ("filter_devseg", "io_pattern")
INCLUDE = re.compile(r"""\s*#\s*include\s*(["<])([^">]+)[">]""")
# Headers of MeshLab and VCG, which the rooms named host include.
HOST_HEADERS = ("common/", "vcg/", "wrap/")
NAME = re.compile(r"`([^`]+)`")


def short(room: str) -> str:
    """The name of a room in the last column of the table."""
    return room.removeprefix(CORE)


def room_of(root: Path, file: Path) -> str:
    """The folder of a file."""
    return file.parent.relative_to(root).as_posix()


def read_includes(root: Path, file: Path) -> Iterator[tuple[str, str, str | None]]:
    """FILE:LINE of each include, its name, and the room that has it."""
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if match := INCLUDE.match(line):
            quoted, name = match[1] == '"', match[2]
            folders = [file.parent] * quoted + [root / top for top in INCLUDE_ROOTS]
            paths = (Path(os.path.normpath(folder / name)) for folder in folders)
            found = next((p for p in paths if p.is_file() and p.is_relative_to(root)), None)
            if found or quoted:
                yield f"{file.relative_to(root)}:{number}", name, found and room_of(root, found)


def read_table(root: Path, findings: list[str]) -> list[tuple[str, list[str], list[str]]]:
    """FILE:LINE of each row, its rooms and what they may include."""
    lines = enumerate((root / TABLE).read_text(encoding="utf-8").splitlines(), 1)
    table = takewhile(lambda at: at[1][:1] == "|", dropwhile(lambda at: at[1][:1] != "|", lines))
    split = [(f"{TABLE}:{n}", [c.strip() for c in line.split("|")[1:-1]]) for n, line in table]
    if not split or split[0][1] != HEAD:
        findings.append(f"{TABLE}: expected a first table with the columns {', '.join(HEAD)}")
    rows = []
    for place, cells in split[2:]:
        rooms, may = NAME.findall(cells[0]), NAME.findall(cells[-1])
        rest = NAME.sub("", cells[-1]).replace(",", "").strip()
        if len(cells) != 3 or not rooms or rest != ("" if may else NOTHING):
            findings.append(f"{place}: expected rooms in backticks and what they may include")
        may = [CORE + name if (root / CORE / name).is_dir() else name for name in may]
        rows.append((place, rooms, may))
    return rows


def cycles(what: str, edges: dict[str, set[str]]) -> Iterator[str]:
    """A line for each cycle, until the rest has none."""
    graph = {room: sorted(targets - {room}) for room, targets in edges.items()}
    while True:
        try:
            return graphlib.TopologicalSorter(graph).prepare()
        except graphlib.CycleError as error:
            cycle = error.args[1][::-1]
            yield f"{what}: cycle {' -> '.join(map(short, cycle))}"
            graph[cycle[0]].remove(cycle[1])


def check_table(root: Path, rooms: dict[str, set[str]], findings: list[str]) -> dict[str, set[str]]:
    """What the table allows each room; rooms says what they really include."""
    allowed: dict[str, set[str]] = {}
    for place, names, may in read_table(root, findings):
        for room in names:
            if room in allowed:
                findings.append(f"{place}: {room} has a row already")
            if not (root / room).is_dir():
                findings.append(f"{place}: room without a folder: {room}")
            allowed[room] = set(may)
        for name in may:
            if not any(name in rooms.get(room, ()) for room in names):
                findings.append(f"{place}: no include uses {short(names[0])} -> {short(name)}")
    findings += [f"{room}: folder not in the table" for room in rooms if room not in allowed]
    return allowed


def main(arguments: list[str] | None = None) -> int:
    """Prints the findings, or the rows; returns 1 if there are findings."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--table", action="store_true", help="print what rooms really include")
    parser.add_argument("--root", type=Path, default=ROOT, help="of the tree; default: this one")
    args = parser.parse_args(arguments)
    root = args.root.resolve()
    found = (file for top in INCLUDE_ROOTS for file in (root / top).rglob("*"))
    files = sorted(file for file in found if file.suffix in (".h", ".cpp"))
    includes = [
        (room_of(root, file), *found) for file in files for found in read_includes(root, file)
    ]
    rooms: dict[str, set[str]] = {room_of(root, file): set() for file in files}
    for room, _, _, target in includes:
        rooms[room] |= {target} - {room, None}
    if args.table:
        for room, targets in sorted(rooms.items()):
            names = ", ".join(f"`{short(target)}`" for target in sorted(targets))
            print(f"| `{room}` | | {names or NOTHING} |")
        return 0
    findings: list[str] = []
    allowed = check_table(root, rooms, findings)
    for room, place, name, target in includes:
        if target is None:
            if "host" not in room.split("/") or not name.startswith(HOST_HEADERS):
                findings.append(f"{place}: no such file: {name}")
        elif target not in {room} | allowed.get(room, set()):
            findings.append(f"{place}: not allowed: {short(room)} -> {short(target)} ({name})")
    findings += [*cycles("table", allowed), *cycles("includes", rooms)]
    print("\n".join(findings) or f"walls: {len(files)} files keep to the table")
    return int(bool(findings))


if __name__ == "__main__":
    sys.exit(main())
