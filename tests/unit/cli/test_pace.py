"""How often pub sends what, by its options and by where the messages come from."""

import math
from dataclasses import replace
from itertools import islice

import pytest

from lcmtools.publish.incoming import Incoming
from lcmtools.publish.pace import Pace, PublishOptions

VALUES = Incoming(iter([]), is_one=True)
ONE_IN_A_FILE = Incoming(iter([]), is_file=True, is_one=True)
FILE = Incoming(iter([]), is_file=True)
STREAM = Incoming(iter([]))


def wish(
    *,
    rate: float | None = None,
    count: int | None = None,
    once: bool = False,
    latches: bool = False,
    keep_alive: float | None = None,
) -> PublishOptions:
    return PublishOptions(rate, 1 if once else count, once, latches, keep_alive)


@pytest.mark.parametrize(
    ("said", "incoming", "pace"),
    [
        (wish(), VALUES, Pace(stay=math.inf)),
        (wish(), ONE_IN_A_FILE, Pace(rate=10.0, is_endless=True)),
        (wish(), FILE, Pace(rate=10.0)),
        (wish(), STREAM, Pace()),
        (wish(rate=5.0), VALUES, Pace(rate=5.0, is_endless=True)),
        (wish(rate=5.0), ONE_IN_A_FILE, Pace(rate=5.0, is_endless=True)),
        (wish(rate=5.0), FILE, Pace(rate=5.0)),
        (wish(rate=5.0), STREAM, Pace(rate=5.0)),
        (wish(once=True), VALUES, Pace(rate=1.0, count=1)),
        (wish(once=True, latches=True), VALUES, Pace(rate=1.0, count=1)),
        (wish(once=True, keep_alive=3.0), VALUES, Pace(rate=1.0, count=1, stay=3.0)),
        (wish(once=True), STREAM, Pace(count=1)),
        (wish(count=3), VALUES, Pace(rate=1.0, count=3)),
        (wish(count=3, rate=5.0), VALUES, Pace(rate=5.0, count=3)),
        (wish(count=3), FILE, Pace(rate=10.0, count=3)),
        (wish(count=3), STREAM, Pace(count=3)),
        (wish(latches=True), ONE_IN_A_FILE, Pace(rate=10.0, stay=math.inf)),
        (wish(latches=True), FILE, Pace(rate=10.0, stay=math.inf)),
        (wish(latches=True), STREAM, Pace(stay=math.inf)),
        (wish(latches=True, rate=5.0), VALUES, Pace(rate=5.0, is_endless=True, stay=math.inf)),
        (wish(keep_alive=3.0), VALUES, Pace(stay=3.0)),
    ],
)
def test_options_and_source_decide_when_to_send(
    said: PublishOptions, incoming: Incoming, pace: Pace
) -> None:
    assert said.pace(incoming) == pace


@pytest.mark.parametrize(
    ("pace", "incoming", "count"),
    [
        (Pace(rate=10.0, is_endless=True), ONE_IN_A_FILE, 5),
        (Pace(rate=10.0), FILE, 2),
        (Pace(rate=10.0, count=4), FILE, 5),
        (Pace(count=4), STREAM, 2),
    ],
)
def test_messages_of_a_file_begin_anew_where_more_are_wanted(
    pace: Pace, incoming: Incoming, count: int
) -> None:
    drafts = pace.drafts(replace(incoming, drafts=iter([None, None])))
    assert sum(1 for _ in islice(drafts, 5)) == count
