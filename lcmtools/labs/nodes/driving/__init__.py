"""Driving a robot by keys: their sources, their meaning, and a loop that stops the robot.

The nodes teleop, pioneer_manual_controller and steering stand on it.
"""
