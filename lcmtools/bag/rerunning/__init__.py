"""Testing programs with recordings."""
