"""`devseg compare`: one mesh segmented by several methods, their measures and their pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from devseg import host
from devseg.apart import READING, Tell, run_apart
from devseg.load import load_mesh
from devseg.methods import FLATTENINGS, Method
from devseg.outputs import plain, staged, to_json
from devseg.pipeline import (
    FLATTEN_FILTER,
    PARAMETRIZATION_MEASURES,
    SEGMENTATION_MEASURES,
    Session,
    segment,
    versions,
)
from devseg.plugins import load_plugins
from devseg.progress import Progress

CIRCLE_MEASURES = "get_circle_map_measures"

# The number of charts that all methods get where nobody asks for one.
CHARTS = 20

# Rows of the table: group and name of a measure, and how it is called.
ROWS = (
    ("segmentation", "charts_number", "charts"),
    ("segmentation", "disk_charts_number", "disks"),
    ("segmentation", "holed_charts_number", "disks with flat holes"),
    ("segmentation", "gauss_area_std", "Gauss area, standard deviation"),
    ("segmentation", "gauss_area_mean", "Gauss area, mean"),
    ("segmentation", "crease_share", "creases on borders, share"),
    ("segmentation", "max_fitting_error", "largest fitting error"),
    ("segmentation", "largest_chart_area_share", "largest chart, share"),
    ("segmentation", "seam_length", "seam length"),
    ("circle", "circle_l2_stretch", "L2 stretch to circle, mean"),
    ("circle", "circle_l2_stretch_std", "L2 stretch to circle, deviation"),
    ("circle", "largest_circle_l2_stretch", "L2 stretch to circle, worst"),
    ("parametrization", "l2_stretch", "L2 stretch, flattened"),
    ("parametrization", "linf_stretch", "Linf stretch, flattened"),
    ("parametrization", "l2_shear", "L2 shear, flattened"),
    ("parametrization", "max_area_change", "largest area change"),
    ("parametrization", "flipped_faces_number", "flipped faces"),
    ("parametrization", "overlapping_faces_number", "overlapping faces"),
    ("parametrization", "packing_efficiency", "packing"),
    ("seconds", "segment", "seconds to segment"),
    ("seconds", "flatten", "seconds to flatten"),
)


@dataclass(frozen=True)
class CompareOptions:
    """What `devseg compare` is to do.

    Attributes:
        out: folder of the picture and the JSON file.
        methods: in the order of the columns.
        segmentation: for each method, parameters that differ from the defaults.
        flatten: key of FLATTENINGS.
    """

    out: Path
    methods: Sequence[Method]
    segmentation: Sequence[Mapping[str, Any]]
    flatten: str


def compare(path: Path, options: CompareOptions) -> dict[str, Any]:
    """Runs all methods and returns what NAME-compare.json holds.

    Raises:
        DevsegError: with nothing written.
    """
    with staged(options.out) as folder:
        return run_apart(str(path), lambda tell: plain(_compare(path, options, folder, tell)))


def _compare(path: Path, options: CompareOptions, folder: Path, tell: Tell) -> dict[str, Any]:
    from devseg.render import render_meshes

    results: dict[str, Any] = {}
    pictures = []
    warnings: list[str] = []
    load_plugins()
    for method, parameters in zip(options.methods, options.segmentation, strict=True):
        progress = Progress(f"{path.stem}, {method.name}", tell=tell)
        with progress.stage(READING):
            loaded = load_mesh(path)
        session = Session(path, loaded.meshes, loaded.warnings)
        with progress.stage("segment"):
            segment(session, method, parameters, CHARTS)
        # Before flattening, which takes charts apart where they would overlap.
        found = {
            "segmentation": session.apply(SEGMENTATION_MEASURES),
            "circle": session.apply(CIRCLE_MEASURES),
        }
        with progress.stage("flatten"):
            session.apply(FLATTEN_FILTER, method=FLATTENINGS[options.flatten])
        found["parametrization"] = session.apply(PARAMETRIZATION_MEASURES)
        results[method.name] = {
            **found,
            "parameters": session.parameters,
            "seconds": progress.seconds,
        }
        warnings += session.warnings
        pictures.append(host.mesh_data(loaded.meshes.current_mesh()))
    stem = f"{path.stem}-compare"
    titles = [method.name for method in options.methods]
    render_meshes(pictures, titles).save(folder / f"{stem}.png")
    result = {
        "input": path.name,
        "methods": results,
        "versions": versions(),
        "warnings": list(dict.fromkeys(warnings)),
        "outputs": {"png": f"{stem}.png", "json": f"{stem}.json"},
    }
    (folder / f"{stem}.json").write_text(to_json(result), encoding="utf-8")
    return result


def table(result: Mapping[str, Any]) -> str:
    """One column for each method, one row for each measure."""
    methods = result["methods"]
    lines = [" " * 34 + "".join(f"{name:>13}" for name in methods)]
    for group, key, title in ROWS:
        numbers = "".join(f"{float(found[group][key]):>13.5g}" for found in methods.values())
        lines.append(f"{title:<34}{numbers}")
    return "\n".join(lines)
