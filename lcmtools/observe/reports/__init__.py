"""Nodes, topics and the graph as text and as values for JSON."""
