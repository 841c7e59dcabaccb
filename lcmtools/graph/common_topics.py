"""The topics that many nodes have, and that are treated apart; each set with its reason.

The sets differ because the questions do.
"""

from lcmtools.clock import CLOCK_TOPIC

OF_EVERY_NODE = frozenset({CLOCK_TOPIC, "/rosout"})
"""Topics that lcmtools itself gives to a node: they say nothing of what a program does."""

OFTEN_UNCONNECTED = frozenset({CLOCK_TOPIC, "/rosout", "/tf", "/tf_static"})
"""Topics that nodes have as a matter of course: one without another end is no fault.

roswtf excepts /clock and /rosout.
"""

MEANT_FOR_MANY = frozenset({"/rosout", "/tf", "/tf_static", "/diagnostics"})
"""Topics that are meant for many publishers, which send when they have something to say.

Not /clock: two clocks contradict each other.
"""

LEFT_OUT_OF_DIAGRAMS = frozenset(
    {CLOCK_TOPIC, "/rosout", "/rosout_agg", "/statistics", "/parameter_events"}
)
"""Topics that nearly every node has, and which would connect everything with everything.

Not /tf: a diagram shows which nodes use the frames.
"""
