"""Few, nearly developable charts of a triangle mesh, flattened, packed and exported as patterns.

The algorithms are two plugins for MeshLab and PyMeshLab; this package loads them into the running
pymeshlab and adds the command line `devseg`. Importing it does no work: pymeshlab is imported by
the first function that needs it.
"""

from devseg.errors import DevsegError
from devseg.plugins import load_plugins, plugin_paths
from devseg.ply import restore_attributes

__version__ = "0.1.0"
__all__ = ["DevsegError", "__version__", "load_plugins", "plugin_paths", "restore_attributes"]
