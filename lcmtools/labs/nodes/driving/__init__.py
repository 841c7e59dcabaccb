"""Driving a robot by keys: what keys mean, where they come from, and the surely ending loop.

The nodes teleop, pioneer_manual_controller and steering stand on it. What is pure here (``keys``,
``key_script``, ``motion``, ``sliders``) knows no terminal, clock or bus.
"""
