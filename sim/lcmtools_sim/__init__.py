"""The simulator: robots, walls and boxes in pybullet, which speak to the bus like any other node.

It uses the public API of lcmtools and is never imported by it. Importing this package imports
nothing else; ``python -m lcmtools_sim`` or ``lcmtools run sim`` starts it.
"""
