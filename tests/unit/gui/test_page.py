"""The frames that a page gets of its streams."""

import math
from typing import ClassVar

import pytest
from fixtures.gui import FakeSource

from lcmtools.gui.page import _Subscription
from lcmtools.gui.streams.base import PageStream, Update
from lcmtools.gui.streams.pool import OpenStream


class Counting(PageStream):
    """A stream with something new whenever it is asked."""

    period: ClassVar[float] = 0.0
    count = 0

    def update(self):
        """Return the next number."""
        self.count += 1
        return Update({"count": self.count})


@pytest.mark.parametrize("is_paced", [False, True])
def test_an_update_of_a_paced_stream_waits_until_the_page_has_taken_the_last(*, is_paced):
    stream = OpenStream(Counting(FakeSource()))
    shown = _Subscription(1, stream, is_paced=is_paced)
    shown.go_on()  # for a stream of this number before
    assert shown.next_frame(10.0)
    assert shown.next_time == (math.inf if is_paced else 10.0)
    for _ in range(2):  # a page may repeat itself
        shown.go_on()
        assert shown.next_time == 10.0
    assert shown.next_frame(11.0)
