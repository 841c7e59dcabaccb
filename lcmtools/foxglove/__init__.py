"""A server for Foxglove and Lichtblick: every channel of a bus, with the types of ROS.

``schemas`` has types and messages in the form that these programs expect, ``bridge`` the flow to
them, and ``client_publisher`` the flow back. Only ``websocket`` knows the package foxglove.
"""
