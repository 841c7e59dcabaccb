"""When a service is asked, and how often. Must not know how."""

import itertools
import time
from collections.abc import Iterator

from lcmtools.messages.message_template import MessageTemplate
from lcmtools.messages.registry import Message
from lcmtools.publish.requests import Drafts

_USUAL_RATE = 1.0  # [Hz] of a service that is asked so many times


def in_time(
    requests: Drafts, rate: float | None, times: int | None
) -> Iterator[MessageTemplate[Message]]:
    """The requests, each when it is due; the next one is taken when the answer has come.

    Args:
        requests: What is asked, in turn.
        rate: How often a second, without end; None for each request once.
        times: How many are asked in all.
    """
    if rate is None and times is None:
        yield from requests
        return
    period, due = 1 / (rate or _USUAL_RATE), time.monotonic()
    for request in itertools.islice(itertools.cycle(requests), times):
        time.sleep(max(0.0, due - time.monotonic()))
        yield request
        due = max(due + period, time.monotonic())  # a slow service is not asked in bursts later
