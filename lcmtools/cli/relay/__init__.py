"""``lcmtools relay``."""
