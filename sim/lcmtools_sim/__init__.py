"""The simulator: robots, walls and boxes in a physics engine, as an ordinary node on the bus.

It uses the public API of lcmtools and is never imported by it. Importing this package imports
nothing else; ``python -m lcmtools_sim`` or ``lcmtools run sim`` starts it.
"""
