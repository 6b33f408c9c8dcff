"""Filters applied in a process of its own: the old pymeshlab has an environment of its own.

As a program it reads {"plugins", "jobs", "answer"} from standard input and writes what `run` gives
into the file "answer".
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

SAMPLE = "bone.ply"

# pymeshlab may keep a pointer to the log of a MeshSet and use it for later ones.
_alive: list[Any] = []


def run(jobs: list[dict[str, Any]]) -> list[list[str]]:
    """Does each job on the sample mesh; the names of the results of its last filter.

    A job may have "mesh", another file; "script", an .mlx file to run; "steps", pairs of a filter
    and its parameters; "history", where to save what was applied as .mlx; "save", where to save
    the mesh.
    """
    import pymeshlab

    sample = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes" / SAMPLE
    answers = []
    for job in jobs:
        meshset = pymeshlab.MeshSet()
        _alive.append(meshset)
        meshset.load_new_mesh(job.get("mesh", str(sample)))
        if "script" in job:
            meshset.load_filter_script(job["script"])
            meshset.apply_filter_script()
        results: dict[str, Any] = {}
        for name, values in job.get("steps", []):
            results = meshset.apply_filter(name, **values) or {}
        if "history" in job:
            meshset.save_filter_script(job["history"])
        if "save" in job:
            meshset.save_current_mesh(job["save"])
        answers.append(sorted(results))
    return answers


def main() -> None:
    import pymeshlab

    order = json.loads(sys.stdin.read())
    for plugin in order["plugins"]:
        pymeshlab.load_plugin(plugin)
    Path(order["answer"]).write_text(json.dumps(run(order["jobs"])))


if __name__ == "__main__":
    main()
