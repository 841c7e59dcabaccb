"""Child processes: started, listened to, signalled, and surely ended.

Must not know launch files, labs or buses.
"""
