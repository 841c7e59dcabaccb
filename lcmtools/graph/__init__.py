"""What is known of the bus: nodes and endpoints as announced, channels and senders as observed.

Plain data and its merging. No socket, no clock: packets and times come in as arguments.
"""
