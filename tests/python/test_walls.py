"""The walls between the rooms of the sources: each kind of breach is found, and nothing else."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT / "scripts"))

import check_walls

NONE = "\N{EN DASH}"
MESH = "filter_devseg/devseg/mesh/mesh.h"
FLATTEN = "filter_devseg/devseg/flatten/flatten.cpp"
HOST = "filter_devseg/host/new/host.cpp"
WRITER = "io_pattern/writers/svg.cpp"
SOURCES = {
    "filter_devseg/devseg/base/errors.h": "#pragma once\n",
    MESH: '#include "devseg/base/errors.h"\n#include <vector>\n',
    "filter_devseg/devseg/mesh/mesh.cpp": '#include "mesh.h"\n#include "devseg/mesh/mesh.h"\n',
    FLATTEN: '#include "devseg/mesh/mesh.h"\n',
    HOST: '#include "../../devseg/mesh/mesh.h"\n#include "common/host.h"\n#include "vcg/a.h"\n',
    "io_pattern/writers/svg.h": "",
    "io_pattern/sheet/sheet.h": '#include "writers/svg.h"\n',
    WRITER: '#include "writers/svg.h"\n  # include "devseg/base/errors.h"\n',
}
HEAD = "| room | what lives there | may include |\n|---|---|---|\n"
ROWS = {
    "base": f"| `filter_devseg/devseg/base` | errors | {NONE} |\n",
    "mesh": "| `filter_devseg/devseg/mesh` | meshes | `base` |\n",
    "flatten": "| `filter_devseg/devseg/flatten` | maps | `mesh` |\n",
    "host": "| `filter_devseg/host`, `filter_devseg/host/new` | adapters | `mesh` |\n",
    "writers": "| `io_pattern/writers` | files | `base` |\n",
    "sheet": "| `io_pattern/sheet` | sheets | `io_pattern/writers` |\n",
    "scripts": f"| `scripts` | no sources | {NONE} |\n",
}

Check = Callable[[dict[str, str], dict[str, str]], list[str]]


@pytest.fixture
def check(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Check:
    """Lines of the check for the tree above with other sources and rows, which must fit its end."""

    def run(sources: dict[str, str], rows: dict[str, str]) -> list[str]:
        (tmp_path / "scripts").mkdir()
        for name, text in {**SOURCES, **sources}.items():
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text(text, encoding="utf-8")
        table = "".join({"head": HEAD, **ROWS, **rows}.values())
        (tmp_path / "docs").mkdir()
        (tmp_path / "docs" / "architecture.md").write_text(
            f"# Title\n\nText.\n\n{table}\n| another | table |\n|---|---|\n| a | b |\n",
            encoding="utf-8",
        )
        failed = check_walls.main(["--root", str(tmp_path)])
        lines = capsys.readouterr().out.splitlines()
        assert failed == (lines != ["walls: 8 files keep to the table"])
        return lines

    return run


def test_a_tree_within_its_walls(check: Check) -> None:
    assert check({}, {}) == ["walls: 8 files keep to the table"]


@pytest.mark.parametrize(
    "include",
    ['"devseg/base/errors.h"', "<devseg/base/errors.h>", '"../base/errors.h"'],
)
def test_an_include_that_the_table_does_not_allow(check: Check, include: str) -> None:
    # What a room includes may include more than the room itself.
    found = check({FLATTEN: SOURCES[FLATTEN] + f"\n#include {include}\n"}, {})
    name = include.strip('"<>')
    assert found == [f"{FLATTEN}:3: not allowed: flatten -> base ({name})"]


def test_a_folder_within_a_room_is_another_room(check: Check) -> None:
    maps = "filter_devseg/devseg/flatten/maps/lscm.h"
    found = check({maps: "", FLATTEN: SOURCES[FLATTEN] + '#include "maps/lscm.h"\n'}, {})
    assert found == [
        "filter_devseg/devseg/flatten/maps: folder not in the table",
        f"{FLATTEN}:2: not allowed: flatten -> flatten/maps (maps/lscm.h)",
    ]


def test_an_include_outside_of_the_rooms(check: Check) -> None:
    found = check(
        {MESH: SOURCES[MESH] + '#include "../../../scripts/a.h"\n', "scripts/a.h": ""}, {}
    )
    assert found == [f"{MESH}:3: not allowed: mesh -> scripts (../../../scripts/a.h)"]


def test_a_folder_without_a_row(check: Check) -> None:
    found = check({"io_pattern/pages/page.cpp": ""}, {})
    assert found == ["io_pattern/pages: folder not in the table"]


def test_a_row_without_a_folder(check: Check) -> None:
    found = check({}, {"pages": f"| `io_pattern/pages` | pages | {NONE} |\n"})
    assert found == ["docs/architecture.md:14: room without a folder: io_pattern/pages"]


def test_two_rows_for_a_room(check: Check) -> None:
    found = check({}, {"again": ROWS["mesh"]})
    assert found == ["docs/architecture.md:14: filter_devseg/devseg/mesh has a row already"]


@pytest.mark.parametrize(
    ("file", "name"),
    [(FLATTEN, "devseg/mesh/gone.h"), (FLATTEN, "common/host.h"), (HOST, "Qt/qt.h")],
)
def test_an_include_without_a_file(check: Check, file: str, name: str) -> None:
    line = SOURCES[file].count("\n") + 1
    found = check({file: SOURCES[file] + f'#include "{name}"\n'}, {})
    assert found == [f"{file}:{line}: no such file: {name}"]


def test_a_cycle_of_the_table(check: Check) -> None:
    found = check({}, {"base": "| `filter_devseg/devseg/base` | errors | `flatten` |\n"})
    assert found == [
        "docs/architecture.md:7: no include uses base -> flatten",
        "table: cycle base -> flatten -> mesh -> base",
    ]


def test_a_cycle_of_includes(check: Check) -> None:
    errors = "filter_devseg/devseg/base/errors.h"
    found = check({errors: '#include "devseg/mesh/mesh.h"\n'}, {})
    assert found == [
        f"{errors}:1: not allowed: base -> mesh (devseg/mesh/mesh.h)",
        "includes: cycle base -> mesh -> base",
    ]


@pytest.mark.parametrize("name", ["base", "nowhere", "flatten"])
def test_an_entry_that_no_include_uses(check: Check, name: str) -> None:
    flatten = f"| `filter_devseg/devseg/flatten` | maps | `mesh`, `{name}` |\n"
    found = check({}, {"flatten": flatten})
    assert found == [f"docs/architecture.md:9: no include uses flatten -> {name}"]


@pytest.mark.parametrize(
    "cell", ["everything below", "`base`, Eigen", "", f"{NONE}, `base`", "base"]
)
def test_prose_in_the_last_column(check: Check, cell: str) -> None:
    found = check({}, {"mesh": f"| `filter_devseg/devseg/mesh` | meshes | {cell} |\n"})
    assert found[0].startswith("docs/architecture.md:8: expected rooms in backticks")


def test_rows_that_are_none(check: Check) -> None:
    found = check(
        {}, {"more": f"| no room | text | {NONE} |\n", "less": f"| `scripts/` | {NONE} |\n"}
    )
    expected = "expected rooms in backticks and what they may include"
    assert [f"docs/architecture.md:{line}: {expected}" for line in (14, 15)] == found


def test_another_table(check: Check) -> None:
    found = check({}, {"head": HEAD.replace("may include", "may use")})
    assert found[0].startswith("docs/architecture.md: expected a first table")


def test_printing_what_is_true(tmp_path: Path, check: Check, capsys: pytest.CaptureFixture) -> None:
    check({}, {"mesh": ""})
    assert check_walls.main(["--root", str(tmp_path), "--table"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"| `filter_devseg/devseg/base` | | {NONE} |",
        "| `filter_devseg/devseg/flatten` | | `mesh` |",
        "| `filter_devseg/devseg/mesh` | | `base` |",
        "| `filter_devseg/host/new` | | `mesh` |",
        "| `io_pattern/sheet` | | `io_pattern/writers` |",
        "| `io_pattern/writers` | | `base` |",
    ]
