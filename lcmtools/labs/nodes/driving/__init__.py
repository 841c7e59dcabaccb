"""Driving a robot by keys: their sources, their meaning, and a loop that stops the robot."""
