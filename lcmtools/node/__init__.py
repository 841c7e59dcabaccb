"""Nodes, the parts of a robot's program. The shape is rclpy's; the bus below is LCM.

Callbacks run on the thread that spins; messages are received and the node is announced on threads
of its own, so a slow callback delays neither.
"""
