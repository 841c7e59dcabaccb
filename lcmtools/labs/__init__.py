"""The three labs: nodes, skeletons, checks of a student's own programs, and commands.

The checks know programs only by what travels on the bus, by what they print, and by the files they
write: a program in any language can be checked. Only the commands know click and print tables.
"""
