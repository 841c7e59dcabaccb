"""Drawing a graph: selecting its parts, and writing them as text, dot, Mermaid or JSON.

Pure: from a diagram of plain values to text.
"""
