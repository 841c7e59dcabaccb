"""Users' own packages: where they are, their nodes, and their message types made usable.

Belongs here: folders with a pyproject.toml or .lcm files, lcm-gen, the cache of what it has made,
and the text of a new package. Must not know the bus, what is inside a message, or how anything is
printed. What is in the environment comes in as an argument.
"""
