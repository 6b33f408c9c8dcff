"""Few, nearly developable charts of a triangle mesh, flattened, packed and exported as patterns.

The algorithms are two plugins for MeshLab and PyMeshLab; this package loads them into the running
pymeshlab, and has functions on arrays and the command line `devseg`. Importing it does no work:
pymeshlab and NumPy are imported by the first function that needs them.
"""

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
