"""Joining buses: a server for LCM's provider tcpq, and relays that carry messages between buses.

Built on ``observe`` and ``bus``. Nothing here prints or knows a command line.
"""
