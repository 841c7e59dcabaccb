"""A server for Foxglove and Lichtblick: every channel of a bus, with the types of ROS.

``schemas`` has types and messages as these programs want them, ``bridge`` what flows to them, and
``publishing`` what comes back. ``websocket`` is all that knows the package foxglove.
"""
