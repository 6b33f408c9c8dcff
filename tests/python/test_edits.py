"""Random pairs of charts joined and split: the atlas stays valid, or nothing changes."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from conftest import ROOT
from devseg import host

PAIRS = 6
MESHES = ("block_4272", "triceratops_5660")


@pytest.fixture(scope="module")
def bench() -> ModuleType:
    folder = ROOT / "tests" / "bench"
    sys.path.insert(0, str(folder))
    try:
        spec = importlib.util.spec_from_file_location("bench_edits", folder / "bench_edits.py")
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(folder))
    return module


@pytest.mark.parametrize("name", MESHES)
def test_atlas_stays_valid_or_as_it_was(
    bench: ModuleType, data: Path, name: str, pymeshlab: ModuleType
) -> None:
    file = next((data / "public").glob(f"{name}.*"))
    with host.captured():
        edits = bench.edited(file, charts=12, pairs=PAIRS)
    assert edits.wrong == []
    assert edits.made[bench.JOIN] + edits.refused[bench.JOIN] == PAIRS
    assert edits.made[bench.JOIN] > 0 and edits.made[bench.SPLIT] > 0
