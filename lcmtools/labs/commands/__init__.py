"""``lcmtools lab``."""
