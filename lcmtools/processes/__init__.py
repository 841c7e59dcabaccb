"""Child processes: started, read, signalled, and certain to end.

Must not know launch files, labs or buses.
"""
