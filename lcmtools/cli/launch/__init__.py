"""``lcmtools launch``: what is typed, what is shown of a plan, and the lines of processes."""
