"""Text formats as plain values with line numbers: strict YAML, XML, safe expressions.

Must not know messages, launch files or worlds.
"""
