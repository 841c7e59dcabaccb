"""``lcmtools lab``: one file a verb."""
