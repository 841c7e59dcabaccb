"""Everything that looks at a bus or a log: arrivals, types, rates, losses, senders, listeners.

Nothing here prints or knows a command line.
"""
