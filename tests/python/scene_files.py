"""Files of several objects, built in code: 3MF, STL as text and Collada; and what runs say."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

import meshes

TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels"
 ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>"""
RELATIONS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="a"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"""
CORE_3MF = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def write_3mf(path: Path, unit: str, content: str = "") -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", TYPES)
        archive.writestr("_rels/.rels", RELATIONS)
        archive.writestr(
            "3D/3dmodel.model",
            f'<?xml version="1.0" encoding="UTF-8"?>\n'
            f'<model{unit} xml:lang="en-US" xmlns="{CORE_3MF}">{content}</model>',
        )
    return path


def text_stl(name: str, mesh: meshes.Mesh) -> str:
    """A solid as text."""
    lines = [f"solid {name}"]
    for corners in mesh[0][mesh[1]]:
        rows = ["vertex {:g} {:g} {:g}".format(*corner) for corner in corners]
        lines += ["facet normal 0 0 0", "outer loop", *rows, "endloop", "endfacet"]
    return "\n".join([*lines, f"endsolid {name}"]) + "\n"


def geometry(name: str, mesh: meshes.Mesh, elements: str) -> str:
    """A geometry of Collada with its positions."""
    row = " ".join(f"{x:g}" for x in mesh[0].ravel())
    axes = "".join(f'<param name="{axis}" type="float"/>' for axis in "XYZ")
    return (
        f'<geometry id="{name}"><mesh><source id="{name}-p">'
        f'<float_array id="{name}-a" count="{mesh[0].size}">{row}</float_array>'
        f'<technique_common><accessor source="#{name}-a" count="{len(mesh[0])}" stride="3">{axes}'
        f'</accessor></technique_common></source><vertices id="{name}-v">'
        f'<input semantic="POSITION" source="#{name}-p"/></vertices>{elements}</mesh></geometry>'
    )


def primitives(kind: str, name: str, rows: np.ndarray, symbol: str) -> str:
    """Triangles, strips, fans or polygons of a geometry, one row each."""
    all_rows = [rows.ravel()] if kind == "triangles" else rows
    ps = "".join(f"<p>{' '.join(map(str, row))}</p>" for row in all_rows)
    vertices = f'<input semantic="VERTEX" source="#{name}-v" offset="0"/>'
    return f'<{kind} count="{len(rows)}" material="{symbol}">{vertices}{ps}</{kind}>'


def write_dae(path: Path, geometries: str, nodes: str) -> Path:
    color = "<diffuse><color>1 0 0.5 1</color></diffuse>"
    path.write_text(
        '<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" '
        'version="1.4.1"><asset><unit meter="0.001"/></asset><library_effects><effect id="e">'
        f'<profile_COMMON><technique sid="c"><lambert>{color}</lambert></technique>'
        "</profile_COMMON></effect></library_effects><library_materials>"
        '<material id="m" name="Red felt"><instance_effect url="#e"/></material>'
        f"</library_materials><library_geometries>{geometries}</library_geometries>"
        f'<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene>'
        '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    )
    return path


def run_json(*arguments: str | float | Path) -> dict[str, Any]:
    """What `devseg run --json` prints, in a process whose host has not seen other meshes."""
    command = [sys.executable, "-m", "devseg", "run", *map(str, arguments)]
    done = subprocess.run(
        [*command, "--json", "--no-picture"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=True,
    )
    result = json.loads(done.stdout)
    told = [line.split(": ", 3)[3] for line in done.stderr.splitlines()]
    assert told == result["warnings"]
    return result


def chunk(kind: int, *parts: bytes) -> bytes:
    """A chunk of a 3DS file."""
    data = b"".join(parts)
    return struct.pack("<HI", kind, 6 + len(data)) + data


def object_3ds(name: str, mesh: meshes.Mesh, materials: dict[str, list[int]]) -> bytes:
    """A mesh with the faces of each material."""
    vertices, faces = mesh
    rows = np.c_[faces, np.zeros(len(faces))].astype("<u2")
    groups = [
        chunk(0x4130, f"{material}\0".encode(), np.array([len(own), *own], dtype="<u2").tobytes())
        for material, own in materials.items()
    ]
    points = chunk(0x4110, struct.pack("<H", len(vertices)), vertices.astype("<f4").tobytes())
    cells = chunk(0x4120, struct.pack("<H", len(faces)), rows.tobytes(), *groups)
    return chunk(0x4000, f"{name}\0".encode(), chunk(0x4100, points, cells))


def write_3ds(path: Path, colors: dict[str, tuple[int, int, int]], *objects: bytes) -> Path:
    """A file of objects, and of materials whose colours are whole numbers to 255."""
    materials = [
        chunk(
            0xAFFF,
            chunk(0xA000, f"{name}\0".encode()),
            chunk(0xA020, chunk(0x0011, bytes(color))),
        )
        for name, color in colors.items()
    ]
    version = chunk(0x0002, struct.pack("<I", 3))
    path.write_bytes(chunk(0x4D4D, version, chunk(0x3D3D, *materials, *objects)))
    return path
