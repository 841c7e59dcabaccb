"""Driving a robot by keys: sources of keys, their meaning, and a loop that stops the robot."""
