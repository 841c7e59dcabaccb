"""Rates, bandwidths, delays, counters and curves. Arithmetic takes times as arguments."""
