"""``lcmtools graph``: what is seen on the bus as a diagram, and where it is written."""
