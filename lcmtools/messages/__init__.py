"""Messages as values: types by name, payloads, conversion to and from text.

Belongs here: everything that is derived from the tables of a generated class. Must not know
channels, the bus, files or the terminal; a message comes in, bytes or text go out, and vice versa.
"""
