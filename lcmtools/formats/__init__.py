"""Parsers of text formats: strict YAML, XML and expressions.

Belongs here: syntax, limits and the place of each mistake. Must not know the meaning of a
text: messages, settings, launch files and worlds are built on top of these parsers.
"""
