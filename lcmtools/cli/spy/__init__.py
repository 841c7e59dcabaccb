"""What ``lcmtools spy`` shows: the channels of a bus and what goes on on them."""
