"""Few, nearly developable charts of a triangle mesh, flattened, packed and exported as patterns.

The algorithms are two plugins for MeshLab and PyMeshLab; this package loads them into the running
pymeshlab, and has functions on arrays and the command line `devseg`. Importing it does no work:
its modules are imported by the first use of their names, pymeshlab and NumPy by the first function
that needs them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from devseg.array_pattern import Pattern, pattern
    from devseg.array_types import Atlas, Charts, CutMesh, Pieces, Preview
    from devseg.arrays import deform, segment, sewn_preview, unwrap
    from devseg.converters import from_trimesh, to_trimesh
    from devseg.errors import Cancelled, DevsegError
    from devseg.plugins import load_plugins, plugin_paths
    from devseg.ply import restore_attributes

__version__ = "0.1.0"
__all__ = [
    "Atlas",
    "Cancelled",
    "Charts",
    "CutMesh",
    "DevsegError",
    "Pattern",
    "Pieces",
    "Preview",
    "__version__",
    "deform",
    "from_trimesh",
    "load_plugins",
    "pattern",
    "plugin_paths",
    "restore_attributes",
    "segment",
    "sewn_preview",
    "to_trimesh",
    "unwrap",
]

# The modules of the names, as above.
_MODULES = {
    "array_pattern": ("Pattern", "pattern"),
    "array_types": ("Atlas", "Charts", "CutMesh", "Pieces", "Preview"),
    "arrays": ("deform", "segment", "sewn_preview", "unwrap"),
    "converters": ("from_trimesh", "to_trimesh"),
    "errors": ("Cancelled", "DevsegError"),
    "plugins": ("load_plugins", "plugin_paths"),
    "ply": ("restore_attributes",),
}


if not TYPE_CHECKING:  # else checkers would take any name

    def __getattr__(name: str) -> Any:
        for module, names in _MODULES.items():
            if name in names:
                value = globals()[name] = getattr(importlib.import_module(f"devseg.{module}"), name)
                return value
        raise AttributeError(f"module 'devseg' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
