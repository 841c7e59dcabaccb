"""Reading what describes worlds: strict YAML, and through it URDF and SDF files.

What is unknown, missing, twice there or out of bounds is an error with file, line and reason. No
engine and no bus are known here.
"""

from lcmtools_sim.world_file.scene import read_scene

__all__ = ["read_scene"]
