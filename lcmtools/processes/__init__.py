"""Child processes: starting, reading and signalling them, and making sure that they end.

Must not know launch files, labs or buses.
"""
