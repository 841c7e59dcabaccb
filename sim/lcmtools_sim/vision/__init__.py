"""Pictures and scans of solid shapes, in plain numpy.

Belongs here: geometry, pictures and their encoding. It must not know the engine, the bus, robots
or time; shapes come in as values, arrays and messages without a header go out.
"""
