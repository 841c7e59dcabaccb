"""Keys of launch files."""

KEYS = {
    **dict.fromkeys(("pkg", "package", "type", "executable"), "run: PACKAGE NODE"),
    "arguments": "args",
    "environment": "env",
    "launch": "nodes",
    "namespace": "ns",
    "parameters": "param",
    "remappings": "remap",
}
"""Keys of ROS's launch files, with the key to write instead."""
