"""The filters of a bus for nodes, run here by a small machine of the tests' own."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.bus import group_receiver, multicast
from lcmtools.bus.group_receiver import GroupReceiver
from lcmtools.bus.kernel import IS_LINUX
from lcmtools.bus.socket_filter import (
    everything,
    these_channels,
    these_endings,
    wanted,
)
from lcmtools.bus.url import parse_url
from lcmtools.wire.datagram import fragments, short_message

_LONG = [f"/{number:02}" + "c" * 60 for number in range(50)]
_IMAGE = list(fragments(1, "/camera/image", bytes(300_000)))
_DENIED = (4000, 300_000)


@pytest.mark.parametrize(
    "program",
    [
        wanted(these_channels(_LONG), [_DENIED] * 16, share=(3, 8)),
        wanted(these_endings([b"%04d" % number for number in range(50)]), [_DENIED] * 16),
    ],
)
def test_the_kernel_takes_programs_of_this_size(program):
    assert len(program) < 4096
    assert all(0 <= step.if_true < 256 and 0 <= step.if_false < 256 for step in program)


@pytest.mark.parametrize("size", [1, 2, 62, 63])
def test_names_of_all_lengths_pass(lets_pass, size):
    program = wanted(these_channels(["c" * size]))
    assert lets_pass(program, short_message(7, "c" * size, b""))
    assert lets_pass(program, short_message(7, "c" * size, b"payload"))
    assert not lets_pass(program, short_message(7, "d" * size, b"payload"))


@given(
    st.sets(st.text("ab", min_size=1, max_size=11), min_size=1, max_size=8),
    st.text("ab", min_size=1, max_size=11),
    st.binary(max_size=3),
)
def test_only_messages_on_the_channels_pass(lets_pass, channels, channel, payload):
    program = wanted(these_channels(channels))
    first = next(fragments(7, channel, payload))
    assert lets_pass(program, short_message(7, channel, payload)) == (channel in channels)
    assert lets_pass(program, first) == (channel in channels)


@given(
    st.sets(st.text("ab", min_size=4, max_size=4), min_size=1, max_size=8),
    st.text("ab", min_size=4, max_size=63),
    st.binary(max_size=3),
)
def test_only_messages_on_channels_with_the_endings_pass(lets_pass, endings, channel, payload):
    program = wanted(these_endings([ending.encode() for ending in endings]))
    first = next(fragments(7, channel, payload))
    assert lets_pass(program, short_message(7, channel, payload)) == (channel[-4:] in endings)
    assert lets_pass(program, first) == (channel[-4:] in endings)


@given(st.binary(max_size=80), st.sampled_from([b"", b"LC02", b"LC03", b"LC04"]))
def test_no_datagram_confuses_a_filter(lets_pass, rest, magic):
    is_known = (magic + rest)[:4] in (b"LC02", b"LC03")
    for test in (everything, these_channels(["/a"]), these_endings([b"/abc"])):
        assert not lets_pass(wanted(test), magic + rest) or is_known


def test_later_fragments_pass_whatever_their_channel(lets_pass):
    program = wanted(these_channels(["/other"]))
    assert [lets_pass(program, part) for part in _IMAGE] == [False, True, True, True, True]


@pytest.mark.parametrize(
    ("port", "size", "passes"),
    [(4000, 300_000, False), (4001, 300_000, True), (4000, 299_999, True)],
)
def test_later_fragments_of_unwanted_messages_are_dropped(lets_pass, port, size, *, passes):
    program = wanted(these_channels(["/camera/image"]), [(9, 9), _DENIED])
    parts = list(fragments(1, "/camera/image", bytes(size)))
    assert [lets_pass(program, part, port) for part in parts] == [True, *[passes] * 4]


def test_each_fragment_passes_to_one_share(lets_pass):
    test = these_channels(["/camera/image"])
    shares = [wanted(test, shorts=False, share=(share, 4)) for share in range(4)]
    passing = [[lets_pass(program, part) for part in _IMAGE] for program in shares]
    assert [sum(column) for column in zip(*passing, strict=True)] == [1] * 5
    shorts = wanted(test, share=None)
    assert not any(lets_pass(shorts, part) for part in _IMAGE)
    short = short_message(1, "/camera/image", b"")
    assert [lets_pass(program, short) for program in (shorts, *shares)] == [True, *[False] * 4]


class Attached:
    """The programs of a receiver's sockets, as the kernel would have them."""

    def __init__(self, monkeypatch):
        self.programs = {}
        for module in (multicast, group_receiver):
            monkeypatch.setattr(module, "attach", self._attach)
        monkeypatch.setattr(group_receiver, "IS_LINUX", True)

    def _attach(self, receiver, program):
        self.programs[receiver] = program
        return True


@pytest.fixture
def attached(monkeypatch):
    """The programs that are attached."""
    return Attached(monkeypatch)


@pytest.mark.usefixtures("attached")
def test_a_fleets_next_robot_passes_a_filter_of_endings_already(bus_url):
    receiver = GroupReceiver(parse_url(bus_url), ())
    receiver.let_pass([f"/husky{number}/odometry" for number in range(50)])
    of_few = receiver.passes("/husky50/odometry")
    receiver.let_pass([f"/husky{number}/odometry" for number in range(51)])
    assert (of_few, receiver.passes("/husky51/odometry")) == (False, True)
    assert not receiver.passes("/husky51/imu")
    receiver.close()


def test_a_receiver_has_more_sockets_when_large_messages_need_them(
    attached, lets_pass, bus_url, monkeypatch
):
    monkeypatch.setattr(multicast, "receive_buffer_bytes", lambda: 212_992)
    receiver = GroupReceiver(parse_url(bus_url), ())
    receiver.let_pass(["/camera/image"])
    receiver.make_room(130_000)  # two fragments: the one buffer holds three of these
    sockets = [len(receiver.all)]
    receiver.make_room(300_000)
    sockets.append(len(receiver.all))
    programs = [attached.programs[one] for one in receiver.all]
    for part in [*_IMAGE, short_message(1, "/camera/image", b"")]:
        assert sum(lets_pass(program, part) for program in programs) == 1
    receiver.unwanted.denied = [_DENIED]
    receiver.attach_filters()
    programs = [attached.programs[one] for one in receiver.all]
    assert not any(lets_pass(program, _IMAGE[-1], 4000) for program in programs)
    receiver.close()
    assert sockets == ([1, 5] if IS_LINUX else [1, 1])


def test_without_filters_one_socket_receives_everything(bus_url, monkeypatch):
    def refuse(*_):
        return False

    for module in (multicast, group_receiver):
        monkeypatch.setattr(module, "attach", refuse)
    monkeypatch.setattr(group_receiver, "IS_LINUX", False)
    receiver = GroupReceiver(parse_url(bus_url), ())
    receiver.let_pass(["/a"])
    receiver.make_room(10_000_000)
    assert len(receiver.all) == 1
    receiver.close()
