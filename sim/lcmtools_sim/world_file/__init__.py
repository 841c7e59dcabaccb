"""Reading world files: strict YAML, and through it URDF and SDF files.

Keys and values that are unknown, missing, given twice or out of bounds are errors with file, line
and reason. No engine and no bus are known here.
"""

from lcmtools_sim.world_file.scene import read_scene

__all__ = ["read_scene"]
