"""A log for Python."""

from pathlib import Path

import pytest
from fixtures.says import raises_saying

import lcmtools.bag
from lcmtools.bag.writer import LogWriter
from lcmtools.errors import BusError, DecodeError, LcmtoolsError, UsageError
from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.packet import Packet, Sender

_SECOND = 1_000_000_000
_START = 1_795_384_180 * _SECOND


@pytest.fixture
def path(tmp_path):
    """A log of 100 s: /speed at 1 Hz, and one payload that is no message."""
    path = tmp_path / "ride.lcmlog"
    with LogWriter(path) as log:
        number = log.sender_number(Sender("127.0.0.1", 1), "/driver")
        message = Float64()
        for second in range(100):
            message.data = float(second)
            log.add(Packet("/speed", encode(message), _START + second * _SECOND), number)
            log.flush()
        log.add(Packet("RAW", b"x", _START + 99 * _SECOND), number)
    return path


def test_a_log_says_what_is_in_it(path):
    with lcmtools.bag.open(path) as log:
        assert (log.start, log.end, log.duration) == (_START, _START + 99 * _SECOND, 99.0)
        assert list(log.topics) == ["/speed", "RAW"]
        assert log.topics["/speed"].types == ("std_msgs/Float64",)
        assert log.topics["/speed"].messages == 100


def test_a_log_gives_the_messages_of_topics_and_times(path):
    with lcmtools.bag.open(path) as log:
        found = list(log.messages("/speed", start="10s", end="end-80s"))
        assert [arrival.message.data for arrival in found] == list(range(10, 20))
        assert {(arrival.topic, arrival.sender) for arrival in found} == {("/speed", "/driver")}
        assert found[0].time == _START + 10 * _SECOND
        found = list(log.messages("/s*", where="m.data > 97"))
        assert [arrival.message.data for arrival in found] == [98, 99]
        with pytest.raises(UsageError, match="'yesterday' is not a time"):
            log.messages("/speed", start="yesterday")


def test_what_cannot_be_decoded_is_an_error_or_reported(path):
    errors = []
    with lcmtools.bag.open(path) as log:
        assert len(list(log.messages(on_error=errors.append))) == 100
        assert len(errors) == 1
        with pytest.warns(UserWarning, match="a message is left out: RAW: too short") as warned:
            assert len([arrival.message for arrival in log]) == 100
        assert [Path(one.filename).name for one in warned] == ["test_log.py"]
        every = list(log.messages(undecoded=True))
    assert len(every) == 101
    odd = [one for one in every if isinstance(one.decoded, DecodeError)]
    assert [(one.topic, one.payload) for one in odd] == [("RAW", b"x")]
    with pytest.raises(DecodeError, match="too short"):
        _ = odd[0].message


def test_a_file_that_is_no_log_is_not_opened(tmp_path):
    with pytest.raises(BusError, match="No such file"):
        lcmtools.bag.open(tmp_path / "none.lcmlog")


def test_a_topic_is_arrays(path):
    with lcmtools.bag.open(path) as log:
        found = log.to_numpy("/speed", start="10s", end="end-80s")
        assert list(found) == ["%time", "data"]
        assert found["data"].tolist() == list(range(10, 20))
        assert found["%time"].tolist() == [_START + n * _SECOND for n in range(10, 20)]
        assert len(log.to_numpy("speed")["data"]) == 100
        with raises_saying(LcmtoolsError, "no messages of /sped ", "did you mean /speed"):
            log.to_numpy("/sped")
        with raises_saying(DecodeError, "too short"):
            log.to_numpy("RAW")
