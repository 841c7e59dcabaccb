"""Drawing a graph: choosing what is drawn, and writing it as text, dot, Mermaid or JSON.

Pure: a diagram of plain values goes in, text comes out. Must not know where the text goes.
"""
