"""Messages as values: types by name, payloads, text in and text out.

Belongs here: everything that is derived from a generated class's own tables. Must not know
channels, the bus, files or the terminal; a message comes in, bytes or text go out, and back.
"""
