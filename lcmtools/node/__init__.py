"""Nodes, the units that a robot's programs consist of. The API is rclpy's; the bus is LCM.

Callbacks run on the thread that spins. Separate threads receive messages and announce the node, so
a slow callback delays neither.
"""
