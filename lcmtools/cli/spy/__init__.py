"""``lcmtools spy``: the channels of a bus and their traffic."""
