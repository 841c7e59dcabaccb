"""Publishing for a person: values from YAML, a file or a stream, subscribers, rate, latch.

Nothing here prints or knows a command line.
"""
