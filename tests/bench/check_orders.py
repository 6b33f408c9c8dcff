"""Checks the order of assembly of patterns by sewing them step by step: a line for each mesh.

Usage: python tests/bench/check_orders.py [--method M] MESH...

Each pattern is made to sew and to glue, by D-Charts or another method of `devseg run`. A watertight
part of the model is closed once, by its own last step, and the last step of all closes one. Nothing
is known here but the pieces that each seam joins. Fails where an order is wrong.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

import devseg
from devseg import guide, host
from sewing import check_order, solids

HEIGHT = 300.0
METHODS = {
    "dcharts": ("compute_segmentation_dcharts_per_face", {}),
    "plush": ("compute_segmentation_plush_seams_per_face", {"method": "LPFB"}),
}


def orders_of(ms: Any, method: str, folder: Path) -> str:
    """What is to say about the current mesh; AssertionError where an order is wrong."""
    mesh = ms.current_mesh()
    watertight, parts = solids(mesh.vertex_matrix(), mesh.face_matrix())
    segmentation, flattening = METHODS[method]
    ms.apply_filter(segmentation)
    ms.apply_filter("compute_texcoord_parametrization_charts_per_wedge", pack=False, **flattening)
    export = {"output_file": str(folder / "order.svg"), "height_mm": HEIGHT}
    text = f"{watertight} of {parts} watertight"
    for preset in ("Sewing", "Papercraft"):
        results = ms.apply_filter("export_pattern", preset=preset, **export)
        order = guide.assembly(results)
        closed = check_order(results, order)
        assert len(closed) >= watertight, f"{preset}: {len(closed)} closed of {watertight} solids"
        assert preset == "Papercraft" or len(order["openings"]) == len(closed), "an opening is lost"
        counts = [len(order["steps"]), len(set(order["sections"].values())), len(closed)]
        text += " | {}: {} steps, {} sections, {} closed".format(preset, *counts)
    return text


def main() -> None:
    """All meshes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--method", choices=METHODS, default="dcharts")
    parser.add_argument("meshes", nargs="+", type=Path)
    arguments = parser.parse_args()
    devseg.load_plugins()
    pymeshlab = host.pymeshlab()
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        for path in arguments.meshes:
            ms = pymeshlab.MeshSet()
            try:
                ms.load_new_mesh(str(path))
                text = orders_of(ms, arguments.method, Path(folder))
            except pymeshlab.PyMeshLabException as error:
                text = f"refused: {error}"
            except AssertionError as error:
                wrong += 1
                text = f"WRONG: {error}"
            print(f"{path.stem}: {text}", flush=True)
    print(f"{wrong} of {len(arguments.meshes)} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
