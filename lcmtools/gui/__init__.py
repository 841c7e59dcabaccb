"""The window: a server that shows a bus or a log to browsers, and lets them send commands.

A page opens streams and gets updates as fast as it can process them; see ``protocol``. Nothing here
knows a command line, and only ``server`` and ``access`` know HTTP.
"""
