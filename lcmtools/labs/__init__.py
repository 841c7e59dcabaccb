"""The labs: what each needs, and whether a student's own programs do what it asks for.

Belongs here: the catalogue, the checks, and the stage they play on (a bus of their own, a
simulator, the programs). The checks know programs only by what travels on the bus, by what they
print, and by the files they write: a program in any language can be checked. Must not know click,
nor how a table is printed.
"""
