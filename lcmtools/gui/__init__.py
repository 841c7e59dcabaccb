"""The window: a server that shows a bus or a log to browsers, and lets them command.

A page opens streams and gets their updates as fast as it takes them; see ``protocol``. Nothing here
knows a command line, and only ``server`` and ``access`` know HTTP.
"""
