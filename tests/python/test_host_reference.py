"""What is generated from the declarations is up to date, what is written by hand complete."""

from __future__ import annotations

import hosts
import reference
from conftest import ROOT


def test_generated_files_are_up_to_date() -> None:
    files = reference.generated_files()
    assert any(path.parent == reference.METHOD_PAGES for path in files)
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


def test_each_segmentation_has_a_page() -> None:
    pages = reference.page_of_filter(reference.method_pages())
    names = {filter_["python_name"] for filter_ in hosts.declarations()}
    assert pages.keys() <= names
    assert {name for name in names if name.startswith("compute_segmentation_")} <= pages.keys()


def test_first_sentences_end_before_capitals() -> None:
    assert reference.first_sentence("Of a face. 0 = none.") == ("Of a face.", "0 = none.")
    assert reference.first_sentence("A file (.svg). More.") == ("A file (.svg).", "More.")
    assert reference.first_sentence("Up to 1.5 units") == ("Up to 1.5 units", "")


def test_every_filter_was_run_in_every_host_without_a_window() -> None:
    page = (ROOT / "docs" / "hosts.md").read_text()
    table = page.split(reference.RUNS)[1].split(reference.END)[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    assert [row[0] for row in rows[2:]] == list(reference.HOSTS.values())
    everything = f"runs: all {len(hosts.declarations())}"
    for host, (_, filters, saving) in zip(reference.HOSTS, rows[2:], strict=True):
        if not host.startswith("window"):
            assert filters.endswith(everything), host
            assert saving == "runs", host


def test_adapters_stay_thin() -> None:
    adapters = [
        *ROOT.glob("filter_devseg/host/meshlab*/*"),
        *ROOT.glob("io_pattern/host/meshlab*/*"),
    ]
    assert len(adapters) == 8
    assert {file.name: n for file in adapters if (n := file.read_text().count("\n")) > 350} == {}
