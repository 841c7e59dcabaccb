"""What can stand at a place of the command line: one file a kind of word.

Each has functions from a ``Situation`` to candidates, which need not begin as the word does: what
does not is left out elsewhere. ``table`` says which kind of word an argument or option is.
"""
