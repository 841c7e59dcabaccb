"""Coordinate frames, from the transforms on a bus or in a log."""
