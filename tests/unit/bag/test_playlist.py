"""Which messages of logs are played, and on which topics."""

import pytest
from fixtures.says import assert_says, raises_saying
from fixtures.wire import encode_event

from lcmtools.arguments import split_arguments
from lcmtools.bag.edits import TopicChoice
from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.errors import BusError, InvalidName, LcmtoolsError
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import NODE_CHANNEL, Announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import fingerprint
from lcmtools.types.geometry_msgs import Point, Twist
from lcmtools.wire.log_events import SYNC
from lcmtools.wire.packet import Packet

S = 1_000_000_000
START = 1_795_000_000 * S


@pytest.fixture
def log(tmp_path):
    """``log("a", ("/a", 1.5), ...)``: a file as lcm-logger writes it, of Twists at seconds."""

    def write(name, *messages):
        path = tmp_path / name
        events = [
            encode_event(
                number,
                Packet(
                    channel, payload[0] if payload else encode(Twist()), START + round(time * S)
                ),
            )
            for number, (channel, time, *payload) in enumerate(messages)
        ]
        path.write_bytes(b"".join(events))
        return path

    return write


def choice(words=(), topics=(), exclude=()):
    return Choice(names=split_arguments(words)[0], topics=TopicChoice(topics, exclude))


def topics(path, what):
    with Playlist([path], what) as playlist:
        return [track.topic for track in playlist.tracks]


def test_logs_are_merged_by_time(log):
    paths = [log("a", ("/a", 0), ("/a", 2), ("/a", 4)), log("b", ("/b", 1), ("/b", 4), ("/b", 5))]
    with Playlist(paths, Choice()) as playlist:
        assert playlist.span == (START, START + 5 * S)
        found = [((m.time - START) / S, m.topic) for m in playlist.messages(*playlist.span)]
        some = list(playlist.messages(START + S, START + 2 * S))
    assert found == [(0, "/a"), (1, "/b"), (2, "/a"), (4, "/a"), (4, "/b"), (5, "/b")]
    assert [one.topic for one in some] == ["/b", "/a"]


def test_payloads_are_as_they_are_in_the_log(log):
    path = log("a", ("PLAIN", 0, b"\0\xff no LCM message"), ("/a", 1, b""))
    with Playlist([path], Choice()) as playlist:
        found = [(m.topic, m.payload) for m in playlist.messages(*playlist.span)]
        assert [track.type for track in playlist.tracks] == ["", ""]
    assert found == [("PLAIN", b"\0\xff no LCM message"), ("/a", b"")]


ALL = ("/a/x", "/a/y", "/b", "PLAIN", "/s/_request", NODE_CHANNEL)


@pytest.mark.parametrize(
    ("what", "expected"),
    [
        (choice(), ["/a/x", "/a/y", "/b", "PLAIN"]),
        (choice(topics=["/a/*", "b"]), ["/a/x", "/a/y", "/b"]),
        (choice(topics=["**"], exclude=["/a/x", "PLAIN"]), ["/a/y", "/b"]),
        (choice(exclude=["/a"]), ["/b", "PLAIN"]),
        (choice(topics=["/s/_request"]), ["/s/_request"]),
        (choice(topics=["/**", "/s/_*"]), ["/a/x", "/a/y", "/b", "/s/_request"]),
        (
            choice(["__ns:=/replay"]),
            ["/replay/a/x", "/replay/a/y", "/replay/b", "/replay/PLAIN"],
        ),
        (choice(["/a/x:=/z", "PLAIN:=plain"]), ["/z", "/a/y", "/b", "/plain"]),
        (choice(["b:=c", "--ns", "n"], topics=["b", "/a/x"]), ["/n/a/x", "/n/c"]),
    ],
)
def test_topics_are_chosen_and_moved(log, what, expected):
    path = log("a", *((name, 0) for name in ALL))
    assert topics(path, what) == expected


def test_the_clock_stays_in_place_where_nodes_are_to_follow_it(log):
    path = log("a", ("/clock", 0), ("/a", 1))
    said = split_arguments(["__ns:=/n"])[0]
    assert topics(path, Choice(names=said)) == ["/n/a", "/n/clock"]
    assert topics(path, Choice(names=said, keeps_clock=True)) == ["/n/a", "/clock"]


def test_a_type_is_as_it_was_announced_else_the_likeliest(log):
    end = Endpoint("/p", Role.PUBLISHER, ("geometry_msgs/Point",), (fingerprint(Point),))
    announced = encode_announcement(Announcement(NodeInfo("/n", "1", "h", 1, endpoints=(end,))))
    point = encode(Point())
    path = log("a", ("/q", 0, point), (NODE_CHANNEL, 1, announced), ("/p", 2, point))
    with Playlist([path], Choice()) as playlist:
        types = {track.topic: track.type for track in playlist.tracks}
    assert types == {"/p": "geometry_msgs/Point", "/q": "geometry_msgs/Vector3"}


def test_damaged_bytes_are_passed_over(log, tmp_path):
    events = log("a", ("/a", 0), ("/a", 1)).read_bytes()
    path = tmp_path / "damaged"
    path.write_bytes(events[:80] + b"\0" * 50 + events + events[:60])
    said = list[str]()
    with Playlist([path], Choice(), said.append) as playlist:
        assert len(list(playlist.messages(*playlist.span))) == 3
    (line,) = (one for one in said if "damaged" in one)
    assert_says(line, "104 B", "do not belong to any message", "lcmtools bag fix")


@pytest.mark.parametrize(
    ("what", "kind", "text"),
    [
        (
            choice(topics=["/a/xx"]),
            LcmtoolsError,
            "there is no topic /a/xx in the log; did you mean /a/x?",
        ),
        (
            choice(topics=["/q*"]),
            LcmtoolsError,
            "there is no topic /q* in the log; lcmtools bag info",
        ),
        (
            choice(exclude=["/a/xx"]),
            LcmtoolsError,
            "there is no topic /a/xx in the log; did you mean /a/x?",
        ),
        (
            choice(["/a/xx:=/c"]),
            LcmtoolsError,
            "there is no topic /a/xx in the log; did you mean /a/x?",
        ),
        (
            choice(topics=[NODE_CHANNEL]),
            LcmtoolsError,
            f"there is no topic {NODE_CHANNEL} in the log",
        ),
        (choice(exclude=["**"]), LcmtoolsError, "are left to play; select other topics"),
        (choice([f"__ns:=/{'n' * 60}"]), InvalidName, "LCM channels have at most 63"),
        (choice(["/b:=1"]), InvalidName, "'1' is not a legal name"),
    ],
)
def test_what_cannot_be_played(log, what, kind, text):
    path = log("a", *((name, 0) for name in ALL if name != "PLAIN"))
    with pytest.raises(kind) as caught:
        Playlist([path], what)
    assert text in str(caught.value)


def test_files_that_are_no_logs(log, tmp_path):
    (tmp_path / "text").write_text("no log\n")
    with raises_saying(LcmtoolsError, "no messages", "text", "not an LCM log"):
        Playlist([log("a", ("/a", 0)), tmp_path / "text"], Choice())
    (tmp_path / "begun").write_bytes(SYNC + bytes(8))
    with raises_saying(LcmtoolsError, "begun", "no messages", "not complete"):
        Playlist([tmp_path / "begun"], Choice())
    with raises_saying(LcmtoolsError, "empty", "no messages", "empty"):
        Playlist([log("empty")], Choice())
    with pytest.raises(BusError, match="cannot read the log"):
        Playlist([tmp_path / "none"], Choice())


def test_a_long_log_without_an_index_is_read_with_a_word(log, monkeypatch):
    path, said = log("a", ("/a", 0)), list[str]()
    Playlist([path], Choice(), said.append).close()
    assert said == []
    monkeypatch.setattr("lcmtools.bag.playlist._SLOW_BYTES", 10)
    Playlist([path], Choice(), said.append).close()
    (line,) = said
    assert_says(line, str(path), "lcmtools bag reindex")


def test_the_latest_message_of_each_topic_before_a_time(log):
    paths = [log("a", ("/a", 0), ("/b", 1), ("/a", 2), ("/a", 4)), log("b", ("/a", 3), ("/c", 5))]
    with Playlist(paths, Choice()) as playlist:

        def found(*names, time, after=-1):
            times = START + round(time * S), START + round(after * S)
            return [(m.topic, (m.time - START) / S) for m in playlist.latest(names, *times)]

        assert found("/a", "/b", "/c", time=3.5) == [("/b", 1), ("/a", 3)]
        assert found("/a", time=2) == [("/a", 2)]
        assert found("/a", "/b", time=5, after=1) == [("/a", 4)]
        assert found("/c", "/gone", time=4) == []
