"""Text formats, each read in one place: strict YAML, XML, and expressions.

Belongs here: syntax, limits and the place of each mistake. Must not know the meaning of a
text: messages, settings, launch files and worlds are built on top of it.
"""
