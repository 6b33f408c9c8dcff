"""Meshes as OFF files for builds that no host can load, as the host hands them to the plugins.

As a program: python dump_meshes.py FOLDER FILE ...
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from devseg import host


def write_off(mesh: Any, path: Path) -> None:
    points, faces = mesh.vertex_matrix(), mesh.face_matrix()
    with path.open("w", encoding="ascii") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        file.writelines(" ".join(f"{x:.17g}" for x in p) + "\n" for p in points)
        file.writelines("3 " + " ".join(map(str, t)) + "\n" for t in faces)


def main() -> None:
    pymeshlab = host.pymeshlab()
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:]:
        meshset = pymeshlab.MeshSet()
        try:
            meshset.load_new_mesh(name)
        except (pymeshlab.PyMeshLabException, MemoryError) as error:  # it never comes to a plugin
            print(f"{name}: {error}")
            continue
        write_off(meshset.current_mesh(), folder / f"{Path(name).name}.off")


if __name__ == "__main__":
    main()
