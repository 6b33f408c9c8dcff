"""All steps of one method on one mesh, for results.py: prints a line of JSON about each.

results_worker.py MESH RUN
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from devseg import DevsegError, host, load_plugins
from devseg.load import load_mesh
from devseg.methods import FLATTENINGS, METHODS
from devseg.pattern_options import EXPORT_FILTER
from devseg.pipeline import (
    DEFORM_FILTER,
    FLATTEN_FILTER,
    PARAMETRIZATION_MEASURES,
    SEGMENTATION_MEASURES,
    Session,
)

THOROUGH = "dcharts"
# Method and parameters of each run.
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    THOROUGH: ("dcharts", {}),
    "dcharts-auto": ("dcharts", {"charts_number": 0, "max_l2_stretch": 1.004}),
    **{name: (name, {}) for name in METHODS if name != "dcharts"},
}
# What follows flattening: name, filter and parameters.
EXPORTS: list[tuple[str, str, dict[str, Any]]] = [
    ("plain.svg", EXPORT_FILTER, {}),
    ("plain.dxf", EXPORT_FILTER, {}),
]
# Of the thorough run only.
STAGES: list[tuple[str, str, dict[str, Any]]] = [
    ("measure segmentation", SEGMENTATION_MEASURES, {}),
    ("measure flattening", PARAMETRIZATION_MEASURES, {}),
    ("measure circles", "get_circle_map_measures", {}),
    ("measure pattern", "get_pattern_measures", {}),
    ("sewing.dxf", EXPORT_FILTER, {"preset": "Sewing"}),
    ("papercraft.pdf", EXPORT_FILTER, {"preset": "Papercraft"}),
    ("pieces", "generate_pattern_pieces", {}),
    ("sewn preview", "generate_sewn_preview", {}),
    ("optimize", "apply_texcoord_pattern_optimization_per_wedge", {}),
]
ATTRIBUTES = ("chart_id", "seam_edges")


def digest(value: Any) -> str:
    """Of the bytes of an array; what is no array is kept as it is."""
    if not isinstance(value, np.ndarray):
        return str(value)
    return hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()


def mesh_parts(mesh: Any) -> dict[str, Any]:
    """All that filters may change."""
    parts: dict[str, Any] = {"vertices": mesh.vertex_matrix(), "faces": mesh.face_matrix()}
    if mesh.has_wedge_tex_coord():
        parts["texture"] = mesh.wedge_tex_coord_matrix()
    if mesh.has_face_scalar():
        parts["quality"] = mesh.face_scalar_array()
    if mesh.has_face_color():
        parts["colors"] = mesh.face_color_matrix()
    for name in ATTRIBUTES:
        with contextlib.suppress(host.pymeshlab().PyMeshLabException):
            parts[name] = mesh.face_custom_scalar_attribute_array(name)
    return parts


def take_step(session: Session, name: str, filter_name: str, **parameters: Any) -> bool:
    """Applies a filter and prints a line about it; whether it did not refuse."""
    meshes = session.meshes
    layer = meshes.current_mesh_id()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, f"pattern{Path(name).suffix}")
        if filter_name == EXPORT_FILTER:
            parameters["output_file"] = str(file)
        start = time.process_time()
        try:
            parts = {f"result {k}": v for k, v in session.call(filter_name, **parameters).items()}
        except DevsegError as error:
            parts = {"refusal": str(error)}
        seconds = time.process_time() - start
        if file.is_file():
            parts["file"] = np.frombuffer(file.read_bytes(), np.uint8)
    # Of the new layer, where the filter has made one.
    parts |= mesh_parts(meshes.current_mesh())
    meshes.set_current_mesh(layer)
    digests = {part: digest(value) for part, value in parts.items()}
    print(json.dumps({"step": name, "seconds": round(seconds, 4), **digests}), flush=True)
    return "refusal" not in parts


def main(path: Path, run: str) -> None:
    load_plugins()
    meshes = load_mesh(path).meshes
    session = Session(Path(path.name), meshes)
    method = METHODS[RUNS[run][0]]
    if not take_step(session, "segment", method.filter, **RUNS[run][1]):
        return
    mesh = meshes.current_mesh()
    shape = mesh.vertex_matrix(), mesh.face_matrix()
    charts = {name: mesh.face_custom_scalar_attribute_array(name).copy() for name in ATTRIBUTES}
    if method.deforms:
        take_step(session, "deform", DEFORM_FILTER)
    if take_step(session, "flatten", FLATTEN_FILTER):
        for name, filter_name, parameters in EXPORTS + STAGES * (run == THOROUGH):
            take_step(session, name, filter_name, **parameters)
    for key, value in FLATTENINGS.items() if run == THOROUGH else ():
        # The default has been taken already.
        if key != method.flatten:
            meshes.add_mesh(host.pymeshlab().Mesh(*shape))
            for name, array in charts.items():
                meshes.current_mesh().add_face_custom_scalar_attribute(array, name)
            take_step(session, f"flatten {key}", FLATTEN_FILTER, method=value)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
