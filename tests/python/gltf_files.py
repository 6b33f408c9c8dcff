"""glTF files built in code: scenes of meshes, and files that lie."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from meshes import Mesh

FLOAT, UNSIGNED = 5126, 5125


def document(*shapes: Mesh, mode: int = 4) -> tuple[dict[str, Any], bytes]:
    """A scene with one node and one mesh for each shape, and its buffer."""
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []
    data = b""
    for vertices, faces in shapes:
        for values, kind, component in ((vertices, "VEC3", FLOAT), (faces, "SCALAR", UNSIGNED)):
            array = np.asarray(values).astype("<f4" if component == FLOAT else "<u4")
            part = array.tobytes()
            views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(part)})
            accessor = {"bufferView": len(views) - 1, "componentType": component, "type": kind}
            accessor["count"] = len(array) if kind == "VEC3" else array.size
            if kind == "VEC3":
                accessor["min"] = array.min(axis=0).tolist()
                accessor["max"] = array.max(axis=0).tolist()
            accessors.append(accessor)
            data += part
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(shapes)))}],
        "nodes": [{"mesh": i, "name": f"object {i}"} for i in range(len(shapes))],
        "meshes": [
            {
                "name": f"mesh {i}",
                "primitives": [
                    {"attributes": {"POSITION": 2 * i}, "indices": 2 * i + 1, "mode": mode}
                ],
            }
            for i in range(len(shapes))
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    return scene, data


def write_gltf(path: Path, scene: dict[str, Any], data: bytes) -> Path:
    """As text, the buffer inside, unless it names a file."""
    for buffer in scene.get("buffers", []):
        if "uri" not in buffer:
            text = base64.b64encode(data).decode()
            buffer["uri"] = f"data:application/octet-stream;base64,{text}"
    path.write_text(json.dumps(scene))
    return path


def write_glb(path: Path, scene: dict[str, Any], data: bytes) -> Path:
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path
