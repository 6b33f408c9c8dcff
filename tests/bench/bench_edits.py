"""Joins and splits random pairs of charts, and looks at the atlas after every step.

    .venv/bin/python tests/bench/bench_edits.py [MESH_OR_FOLDER...] [--pairs N] [--charts N]

The default folder is public/ in DEVSEG_DATA. Each pair of neighbours is joined, and one of what is
left of it is split; the next pair is one of the new atlas. After each step the charts are flattened
and measured: all are disks or have flat holes, none is flipped, none lies on itself, and a joined
chart is in one piece. A refusal has to leave everything as it was. Prints a row for each mesh and
ends with 1 where something was wrong.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from bench_public import mesh_files

from devseg import host, load_plugins
from devseg.load import load_mesh

JOIN, SPLIT = "apply_charts_join_selected", "apply_charts_split_selected"
FLATTEN = "compute_texcoord_parametrization_charts_per_wedge"


def state(mesh: Any) -> list[np.ndarray]:
    return [
        mesh.face_custom_scalar_attribute_array("chart_id"),
        mesh.face_custom_scalar_attribute_array("seam_edges"),
        mesh.face_color_matrix(),
        mesh.wedge_tex_coord_matrix(),
        mesh.vertex_matrix(),
        mesh.face_matrix(),
    ]


def neighbours(mesh: Any) -> list[tuple[int, int]]:
    """Pairs of charts with a common border, ascending."""
    faces = mesh.face_matrix()
    chart = mesh.face_custom_scalar_attribute_array("chart_id").astype(int)
    edges = np.sort(np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    of_edge = np.tile(chart, 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, of_edge = edges[order], of_edge[order]
    twins = (edges[1:] == edges[:-1]).all(axis=1) & (of_edge[1:] != of_edge[:-1])
    pairs = np.sort(np.stack([of_edge[1:], of_edge[:-1]], axis=1)[twins], axis=1)
    return [(int(a), int(b)) for a, b in np.unique(pairs, axis=0)]


def select(meshes: Any, charts: list[int]) -> None:
    meshes.compute_selection_by_condition_per_face(
        condselect=" || ".join(f"(chart_id == {c})" for c in charts)
    )


def faults(meshes: Any, name: str) -> str:
    """What is wrong with the atlas, once it is flat; nothing if all is well."""
    flat = getattr(meshes, FLATTEN)(pack=False)
    found = meshes.get_parametrization_measures()
    wrong = {
        "cuts of joined charts": flat["overlap_cuts_number"] if name == JOIN else 0,
        "charts that are no disks": found["charts_number"]
        - found["disk_charts_number"]
        - found["holed_charts_number"],
        "flips": found["flipped_faces_number"],
        "overlaps": found["overlapping_faces_number"],
    }
    return ", ".join(f"{n} {what}" for what, n in wrong.items() if n)


class Edits:
    """Steps on one mesh, counted."""

    def __init__(self, path: Path, charts: int) -> None:
        self.meshes = load_mesh(path).meshes
        self.meshes.compute_segmentation_dcharts_per_face(charts_number=charts)
        getattr(self.meshes, FLATTEN)(pack=False)
        self.made = {JOIN: 0, SPLIT: 0}
        self.refused = {JOIN: 0, SPLIT: 0}
        self.seconds: dict[str, list[float]] = {JOIN: [], SPLIT: []}
        self.wrong: list[str] = []

    def step(self, name: str, charts: list[int]) -> None:
        select(self.meshes, charts)
        before = state(self.meshes.current_mesh())
        start = time.process_time()
        try:
            self.meshes.apply_filter(name)
        except host.pymeshlab().PyMeshLabException as error:
            self.seconds[name].append(time.process_time() - start)
            self.refused[name] += 1
            if "force: expected" not in str(error) and "expected charts that hang" not in str(
                error
            ):
                self.wrong.append(str(error))
            for old, new in zip(before, state(self.meshes.current_mesh()), strict=True):
                if not np.array_equal(old, new):
                    self.wrong.append(f"{name} {charts} was refused and changed the mesh")
            return
        self.seconds[name].append(time.process_time() - start)
        self.made[name] += 1
        if found := faults(self.meshes, name):
            self.wrong.append(f"{name} {charts}: {found}")

    def row(self, path: Path) -> str:
        cells = [path.stem, f"{self.meshes.current_mesh().face_number():,}"]
        for name in (JOIN, SPLIT):
            seconds = sorted(self.seconds[name]) or [0.0]
            cells += [
                f"{self.made[name]} / {self.refused[name]}",
                f"{seconds[len(seconds) // 2]:.2f} / {seconds[-1]:.2f}",
            ]
        return "| " + " | ".join([*cells, str(len(self.wrong))]) + " |"


def pairs_of(edits: Edits, number: int) -> Iterator[tuple[int, int]]:
    drawn = random.Random(1)
    for _ in range(number):
        choice = neighbours(edits.meshes.current_mesh())
        if not choice:  # one chart is left
            edits.step(SPLIT, [0])
            choice = neighbours(edits.meshes.current_mesh())
        if choice:
            yield drawn.choice(choice)


def edited(path: Path, charts: int, pairs: int) -> Edits:
    """The mesh after so many pairs."""
    edits = Edits(path, charts)
    for a, b in pairs_of(edits, pairs):
        edits.step(JOIN, [a, b])
        edits.step(SPLIT, [a])
    return edits


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mesh", nargs="*", type=Path)
    parser.add_argument("--pairs", type=int, default=50)
    parser.add_argument("--charts", type=int, default=12)
    args = parser.parse_args()
    load_plugins()
    print("| mesh | faces | joined / refused | s, median / most | split / refused | s | wrong |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    wrong = 0
    for path in mesh_files(args.mesh):
        with host.captured():
            edits = edited(path, args.charts, args.pairs)
        print(edits.row(path), flush=True)
        for sentence in edits.wrong:
            print(sentence, file=sys.stderr)
        wrong += len(edits.wrong)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
