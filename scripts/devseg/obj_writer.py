"""OBJ files with the objects, groups and materials of the input, and the new texture coordinates.

The host's own writer names normals that it does not write, joins triangles to polygons across the
borders of charts, and knows no names.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from devseg.materials import library
from devseg.obj_parts import Part


def write_obj(file: Path, mesh: Any, parts: Sequence[Part], part_ids: Any, source: Path) -> None:
    """Writes FILE and FILE.mtl; faces stay in their order.

    Args:
        file: the OBJ file.
        mesh: the pymeshlab mesh, with charts, their colours and texture coordinates.
        parts: of the input.
        part_ids: of each face, #F.
        source: the input, for its materials.
    """
    import numpy as np

    charts = mesh.face_custom_scalar_attribute_array("chart_id").astype(np.int64)
    if any(part.material for part in parts):
        materials = [part.material or "none" for part in parts]
        names = [materials[i] for i in part_ids]
        text = library(source, list(dict.fromkeys(materials)))
    else:
        names = [f"chart_{chart + 1}" for chart in charts]
        text = _chart_materials(charts, mesh.face_color_matrix())
    lines = [f"# devseg: texture coordinates of {int(charts.max()) + 1} charts"]
    lines.append(f"mtllib {file.name}.mtl")
    lines += _vertex_lines(mesh)
    coordinates, corners = np.unique(
        mesh.wedge_tex_coord_matrix().astype(np.float32).reshape(-1, 2), axis=0, return_inverse=True
    )
    lines += [f"vt {u:.9g} {v:.9g}" for u, v in coordinates.tolist()]
    lines += _face_lines(mesh, corners.reshape(-1, 3), parts, part_ids, names)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    Path(f"{file}.mtl").write_text(text, encoding="utf-8")


def _vertex_lines(mesh: Any) -> list[str]:
    points = mesh.vertex_matrix().tolist()
    if not mesh.has_vertex_color():
        return [f"v {x!r} {y!r} {z!r}" for x, y, z in points]
    colors = mesh.vertex_color_matrix()[:, :3].tolist()
    return [
        f"v {x!r} {y!r} {z!r} {r:.4g} {g:.4g} {b:.4g}"
        for (x, y, z), (r, g, b) in zip(points, colors, strict=True)
    ]


def _face_lines(
    mesh: Any, corners: Any, parts: Sequence[Part], part_ids: Any, materials: Sequence[str]
) -> list[str]:
    lines = []
    before = ("", "", "")
    rows = zip(
        (mesh.face_matrix() + 1).tolist(),
        (corners + 1).tolist(),
        part_ids.tolist(),
        materials,
        strict=True,
    )
    for (a, b, c), (s, t, u), part, material in rows:
        now = (parts[part].object, parts[part].group, material)
        if now != before:
            if now[0] != before[0]:
                lines.append(f"o {now[0]}")
            if now[1] != before[1] or (now[1] and now[0] != before[0]):
                lines.append(f"g {now[1]}")
            if now[2] != before[2]:
                lines.append(f"usemtl {material}")
            before = now
        lines.append(f"f {a}/{s} {b}/{t} {c}/{u}")
    return lines


def _chart_materials(charts: Any, colors: Any) -> str:
    import numpy as np

    _, first = np.unique(charts, return_index=True)
    rows = colors[first, :3].tolist()
    return "\n".join(
        f"newmtl chart_{i + 1}\nKd {r:.6g} {g:.6g} {b:.6g}\nillum 1\n"
        for i, (r, g, b) in enumerate(rows)
    )
