"""Runs filters and command lines over many meshes in one process, and says of each how it ended.

As a program: reads {"files", "filters", "commands", "folder", "answer"} as one JSON
object from standard input and writes one JSON object a line to the file "answer": before each step
{"begin": ...}, after it {"end": ...}, so that whoever started it knows what crashed or hung.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import shutil
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"
DCHARTS = "compute_segmentation_dcharts_per_face"
ATTRIBUTES = ("chart_id", "seam_edges")


# Filters that work on what is selected.
CHOOSING = ("apply_charts_", "compute_charts_from_selected")


def fingerprint(meshset: Any) -> str:
    """A digest of all that filters may change: geometry, colours, qualities, coordinates, charts.

    The selection is not among it: a refusal selects the faces that it is about.
    """
    mesh = meshset.current_mesh()
    digest = hashlib.sha256()
    parts = [mesh.vertex_matrix(), mesh.face_matrix()]
    if mesh.has_wedge_tex_coord():
        parts.append(mesh.wedge_tex_coord_matrix())
    if mesh.has_face_scalar():
        parts.append(mesh.face_scalar_array())
    if mesh.has_face_color():
        parts.append(mesh.face_color_matrix())
    for name in ATTRIBUTES:
        with contextlib.suppress(Exception):
            parts.append(mesh.face_custom_scalar_attribute_array(name))
    for part in parts:
        digest.update(np.ascontiguousarray(part).tobytes())
    # pymeshlab 2022.2 calls it number_meshes.
    count = (getattr(meshset, "mesh_number", None) or meshset.number_meshes)()
    return f"{count} {digest.hexdigest()}"


def problems_of_result(meshset: Any, name: str, results: dict[str, Any]) -> list[str]:
    """What is wrong after a filter has succeeded."""
    mesh = meshset.current_mesh()
    found = [
        key for key, value in results.items() if np.isnan(np.asarray(value, dtype=float)).any()
    ]
    problems = [f"{key} is no number" for key in found]
    if name.startswith("compute_segmentation") or name == FLATTEN:
        ids = mesh.face_custom_scalar_attribute_array("chart_id")
        if not np.array_equal(np.unique(ids), np.arange(results["charts_number"])):
            problems.append("chart_id is not 0 to n - 1")
    if name == FLATTEN:
        uv = mesh.wedge_tex_coord_matrix()
        if not (np.isfinite(uv).all() and uv.min() >= 0 and uv.max() <= 1):
            problems.append("texture coordinates outside of the unit square")
        measures = meshset.apply_filter("get_parametrization_measures")
        for key in ("flipped_faces_number", "overlapping_faces_number"):
            if measures[key] != 0:
                problems.append(f"{key} = {measures[key]}")
        if (
            measures["disk_charts_number"] + measures["holed_charts_number"]
            != measures["charts_number"]
        ):
            problems.append("a chart is no disk")
    return problems


class Corpus:
    """The steps that one file goes through."""

    def __init__(self, order: dict[str, Any], tell: Callable[[dict[str, Any]], None]) -> None:
        import devseg
        from devseg import host

        devseg.load_plugins()
        self.host = host
        self.pymeshlab = host.pymeshlab()
        self.order = order
        self.tell = tell

    def step(self, file: str, what: str, work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """Does the work, and tells of its begin and its end."""
        self.tell({"begin": what, "file": file})
        start = time.monotonic()
        answer = work()
        seconds = time.monotonic() - start
        self.tell({"end": what, "file": file, "seconds": round(seconds, 2), **answer})
        return answer

    def run(self, path: Path) -> None:
        from devseg.load import load_mesh, release

        file = path.name

        def load() -> dict[str, Any]:
            try:
                self.meshset = load_mesh(path).meshes
            except Exception as error:
                return {"error": f"{type(error).__name__}: {error}"}
            return {"faces": self.meshset.current_mesh().face_number()}

        loaded = "error" not in self.step(file, "load", load)
        if loaded:
            for name in self.order["filters"]:
                self.step(file, name, lambda name=name: self.apply(name))
        for options in self.order["commands"].get(file, []):
            what = " ".join(["devseg run", *options])
            self.step(file, what, lambda o=options: self.command(path, o))
        release()

    def apply(self, name: str) -> dict[str, Any]:
        """One filter, with the charts and coordinates that the filters before it have left."""
        folder = Path(self.order["folder"])
        parameters: dict[str, Any] = {}
        faces = self.meshset.current_mesh().face_number()
        declared = self.meshset.filter_parameter_values(name)
        if "charts_number" in declared:
            parameters["charts_number"] = max(1, min(declared["charts_number"], faces))
        if "output_file" in declared:
            parameters["output_file"] = str(folder / "pattern.pdf")
        if name.startswith(CHOOSING):
            self.choose()
        before = fingerprint(self.meshset)
        current = self.meshset.current_mesh_id()
        # Where a filter fails, a host that is not verbose goes on swallowing what is printed, also
        # what it says of later files.
        self.meshset.set_verbosity(True)
        try:
            with self.host.captured():
                results = self.meshset.apply_filter(name, **parameters) or {}
        except self.pymeshlab.PyMeshLabException as error:
            answer: dict[str, Any] = {"error": str(error)}
            if fingerprint(self.meshset) != before:
                answer["problems"] = ["the mesh has changed although the filter refused it"]
            if "output_file" in parameters and any(folder.iterdir()):
                answer["problems"] = ["a file was left by an export that failed"]
            return answer
        finally:
            self.meshset.set_verbosity(False)
        self.meshset.set_current_mesh(current)
        problems = problems_of_result(self.meshset, name, results)
        if name.startswith(("get_", "export_")) and fingerprint(self.meshset) != before:
            problems.append("a filter that only reads has changed the mesh")
        for left in folder.iterdir():
            left.unlink()
        return {"problems": problems}

    def choose(self) -> None:
        """Selects a few faces and vertices."""
        for what, condition in (("face", "fi < 9"), ("vertex", "vi < 2")):
            name = f"compute_selection_by_condition_per_{what}"
            self.meshset.apply_filter(name, condselect=condition)

    def command(self, path: Path, options: list[str]) -> dict[str, Any]:
        """The command line, in this process: what it says, and what it leaves."""
        from devseg.cli import main

        out = Path(self.order["folder"]) / "out"
        formats = options[options.index("--formats") + 1]
        arguments = ["run", str(path), "-o", str(out), *options]
        said, complained = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(complained):
            status = main(arguments)
        left = sorted(file.name for file in out.iterdir()) if out.is_dir() else []
        shutil.rmtree(out, ignore_errors=True)
        answer: dict[str, Any] = {"status": status, "files": left, "stderr": complained.getvalue()}
        problems = []
        errors = [line for line in answer["stderr"].splitlines() if "devseg: error:" in line]
        kinds = [*formats.split(","), "png", "json"]
        kinds += ["obj.mtl"] if "obj" in kinds else []  # which the host writes beside it
        expected = sorted(f"{path.stem}.{kind}" for kind in kinds)
        if status == 0 and (errors or left != expected):
            problems.append(f"expected {expected}, found {left}")
        if status != 0 and (status != 1 or left or len(errors) != 1 or "unexpected" in errors[0]):
            problems.append(f"status {status}, errors {errors}, files {left}")
        return {**answer, "problems": problems}


def main() -> None:
    order = json.loads(sys.stdin.read())
    with open(order["answer"], "a", encoding="utf-8") as answer:

        def tell(record: dict[str, Any]) -> None:
            answer.write(json.dumps(record) + "\n")
            answer.flush()

        corpus = Corpus(order, tell)
        for file in order["files"]:
            corpus.run(Path(file))
            tell({"done": Path(file).name})
    os._exit(0)  # the host's own clean-up is not what is tested here


if __name__ == "__main__":
    main()
