"""Filters with ever more memory, in a process of its own; prints how each attempt ended, as JSON.

As a program: python resource_worker.py FOLDER
"""

from __future__ import annotations

import contextlib
import json
import resource
import sys
from pathlib import Path
from typing import Any

import meshes
from corpus_worker import DCHARTS, FLATTEN, fingerprint

MEGABYTE = 1 << 20


def virtual_size() -> int:
    """Bytes of address space in use."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * resource.getpagesize()


def attempts(meshset: Any, name: str, error: type[Exception], **parameters: Any) -> list[str]:
    """Applies the filter with 1 MB more than now, then with more, until it succeeds."""
    outcomes = []
    allowed = 1.0
    while not outcomes or outcomes[-1] != "done":
        before = fingerprint(meshset)
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (virtual_size() + int(allowed * MEGABYTE), hard))
        try:
            meshset.apply_filter(name, **parameters)
            outcome = "done"
        except error as failure:
            outcome = str(failure)
        except MemoryError:
            outcome = "MemoryError"
        finally:
            resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
        if outcome != "done" and fingerprint(meshset) != before:
            outcome += " (the mesh has changed)"
        outcomes.append(outcome)
        allowed = 1.2 * allowed + 0.5
    return outcomes


def main() -> None:
    import devseg
    from devseg import host

    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    folder = Path(sys.argv[1])
    # Once on a small mesh: the dynamic linker, which binds functions when they are first called,
    # ends the process where it has no memory.
    small = pymeshlab.MeshSet()
    small.add_mesh(pymeshlab.Mesh(*meshes.sphere(20, 10)))
    with host.captured():
        for name in (DCHARTS, FLATTEN):
            small.apply_filter(name)
        small.apply_filter("export_pattern", output_file=str(folder / "pattern.pdf"))
        small.apply_filter("generate_pattern_pieces")
        with contextlib.suppress(pymeshlab.PyMeshLabException):
            small.apply_filter(DCHARTS, charts_number=-1)
    (folder / "pattern.pdf").unlink()
    meshset = pymeshlab.MeshSet()
    meshset.add_mesh(pymeshlab.Mesh(*meshes.sphere(160, 100)))
    outcomes = {}
    with host.captured():
        for name, parameters in (
            (DCHARTS, {}),
            (FLATTEN, {}),
            ("export_pattern", {"output_file": str(folder / "pattern.pdf")}),
            ("generate_pattern_pieces", {}),
        ):
            outcomes[name] = attempts(meshset, name, pymeshlab.PyMeshLabException, **parameters)
    outcomes["files"] = sorted(file.name for file in folder.iterdir())
    print(json.dumps(outcomes))


if __name__ == "__main__":
    main()
