"""Launch files: from text to a plan of processes, and the supervisor that runs one.

Belongs here: the two kinds of launch files (YAML, and ROS 1's XML), what they mean, which program a
node is, and the care for processes that run. Must not know how anything is printed, nor the bus.
"""
