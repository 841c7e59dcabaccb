"""Launch files: from text to a plan of processes, and the supervisor that runs a plan.

Belongs here: the two kinds of launch files (YAML, and ROS 1's XML), their meaning, the program of
each node, and the supervision of processes. Must not know the bus, and prints nothing. A mistake in
a file, wherever it is found, is an ``InvalidFile`` with the file and line.
"""
