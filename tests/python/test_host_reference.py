"""What is generated from the declarations is up to date, what is written by hand complete."""

from __future__ import annotations

import hosts
import reference
from conftest import ROOT


def test_generated_files_are_up_to_date() -> None:
    files = reference.generated_files()
    assert {path for path, text in files.items() if (ROOT / path).read_text() != text} == set()
    shipped = {path.relative_to(ROOT) for path in (ROOT / reference.MLX).iterdir()}
    assert shipped <= files.keys()


def test_each_segmentation_has_a_script() -> None:
    names = [filter_["python_name"] for filter_ in hosts.declarations()]
    segmentations = [name for name in names if name.startswith("compute_segmentation_")]
    assert segmentations
    assert len(reference.mlx_scripts(hosts.declarations())) == len(segmentations)


def test_readme_names_every_filter() -> None:
    readme = (ROOT / "README.md").read_text()
    for filter_ in hosts.declarations():
        assert f"| {filter_['menu_name']} | `{filter_['python_name']}` |" in readme


def test_hosts_page_has_a_row_for_every_filter() -> None:
    table = (ROOT / "docs" / "hosts.md").read_text()
    for filter_ in hosts.declarations():
        assert f"\n| {filter_['menu_name']} |" in table
