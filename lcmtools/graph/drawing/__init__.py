"""Pictures of a graph: what is drawn of it, and writing that as text, dot, Mermaid, JSON or SVG.

Pure: a diagram of plain values goes in, text comes out. What is on the bus and whose process it is
comes from outside, as does where the text goes.
"""
