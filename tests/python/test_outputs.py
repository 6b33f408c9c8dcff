"""Outputs appear complete or not at all, and errors are told in one line."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from devseg import DevsegError
from devseg.errors import host_message
from devseg.outputs import staged, to_json
from devseg.pipeline import tell_charts_above


def test_files_appear_together_at_the_end(tmp_path: Path) -> None:
    out = tmp_path / "new" / "folder"
    with staged(out) as folder:
        (folder / "a.svg").write_text("a")
        assert [p.name for p in out.iterdir()] == [folder.name]
    assert [p.name for p in out.iterdir()] == ["a.svg"]


def test_failure_leaves_nothing_behind(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(ZeroDivisionError), staged(out) as folder:
        (folder / "a.svg").write_text("a")
        raise ZeroDivisionError
    assert not out.exists()


def test_failure_keeps_older_results(tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text("old")
    with pytest.raises(KeyboardInterrupt), staged(tmp_path) as folder:
        (folder / "a.svg").write_text("new")
        raise KeyboardInterrupt
    assert [p.read_text() for p in tmp_path.iterdir()] == ["old"]


def test_folder_in_the_way_is_named(tmp_path: Path) -> None:
    (tmp_path / "b.svg").mkdir()
    with pytest.raises(DevsegError, match=r"b\.svg is a folder"), staged(tmp_path) as folder:
        (folder / "a.svg").write_text("a")
        (folder / "b.svg").write_text("b")
    assert [p.name for p in tmp_path.iterdir()] == ["b.svg"]


def test_out_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(DevsegError, match="cannot write into"), staged(tmp_path / "file"):
        pass


def test_json_is_strict() -> None:
    value = {"a": np.array([1.5, 2.0]), "b": math.inf, "c": (np.int64(3), math.nan), "d": True}
    assert json.loads(to_json(value)) == {"a": [1.5, 2.0], "b": None, "c": [3, None], "d": True}


def test_host_message_is_the_filters_own() -> None:
    text = "Failed to apply filter: f\nDetails: expected 1,\nfound 2"
    assert host_message(RuntimeError(text)) == "expected 1, found 2"
    assert "memory" in host_message(MemoryError())


def test_charts_that_are_above_their_bound_once_flat_are_told() -> None:
    """Most are parts of charts that are cut apart; what a filter told of is not told again."""
    options = SimpleNamespace(method=SimpleNamespace(filter="segment"))
    bound = {"max_chart_l2_stretch": 1.02}
    session = SimpleNamespace(parameters={"segment": bound}, warnings=[])
    measures = {
        "flattening": {"thin_charts_number": 1},
        "parametrization": {"chart_l2_stretch": [1.0, 1.3, 1.0200001, 1.03, 1.021]},
    }
    tell_charts_above(session, options, {"rough_charts_number": 2}, measures)
    assert session.warnings == []
    tell_charts_above(session, options, {"rough_charts_number": 1}, measures)
    assert len(session.warnings) == 1 and session.warnings[0].startswith("1 charts are above")
