"""The tables by which requests and streams are imported when a page first needs them."""

import pytest

from lcmtools.gui.requests import ACTIONS, ASKS, answer
from lcmtools.gui.streams import STREAMS, stream_class
from lcmtools.gui.streams.base import PageStream


@pytest.mark.parametrize("table", [ASKS, ACTIONS], ids=["asks", "actions"])
def test_each_request_has_its_function(table: dict[str, str]) -> None:
    assert all(callable(answer(name, table)) for name in table)


@pytest.mark.parametrize("name", STREAMS)
def test_each_stream_has_its_class(name: str) -> None:
    assert issubclass(stream_class(name), PageStream)
