"""The command line: the only package that knows click, prints, and ends the process.

One file a verb: parse, ask the library, print.
"""
