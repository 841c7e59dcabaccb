"""The graph of a bus: announced nodes and endpoints, observed channels and senders.

Plain data and its merging. No socket, no clock: packets and times come in as arguments.
"""
