"""Rows of channels: types, senders, listeners and loss, as far as they are known."""

from lcmtools.bus.processes import Process
from lcmtools.bus.sockets import SocketTable, UdpSocket
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Endpoint, Graph, NodeInfo, Role, Staleness
from lcmtools.messages.codec import encode
from lcmtools.observe.channels.activity import Activity
from lcmtools.observe.channels.rows import ChannelRow, ChannelRows, ChannelSelection
from lcmtools.observe.reading.losses import losses
from lcmtools.observe.reading.senders import SenderNames
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence

S = 1_000_000_000
NOW = 1_795_000_000 * S
NODE = Sender("127.0.0.1", 1000)
PROGRAM = Sender("127.0.0.1", 2000)
FAR = Sender("10.9.8.7", 3000)
POINT = encode(Vector3())


def names():
    process = Process(42, "/usr/bin/python3 -u /home/me/drive.py --fast")
    rows = {1: UdpSocket("127.0.0.1", 2000, 1, 0, 0)}
    return SenderNames(lambda: SocketTable(rows, {1: process}))


def packet(channel, sender, seqno=0, payload=POINT):
    return Packet(channel, payload, NOW + seqno * S // 10, sender, seqno)


def make(
    packets,
    nodes=(),
    selection=ChannelSelection(),  # noqa: B008 - frozen
    *,
    with_numbers=True,
):
    """The rows of a bus, by channel."""
    activity, builder = Activity(), GraphBuilder()
    numbers = {}
    for one in packets:
        activity.add(one)
        builder.add(one)
        if one.sender is not None and one.seqno is not None:
            numbers.setdefault(one.sender, Sequence()).add(one.seqno)
    now = NOW + 2 * S
    graph = Graph(nodes, builder.snapshot(now).traffic, now)
    lost = losses(numbers) if with_numbers else {}
    rows = ChannelRows(selection, names()).make(graph, activity, lost, now)
    return {row.channel: row for row in rows}


def node(name, *ends, sender=None, stale=""):
    return NodeInfo(name, name, "h", 7, endpoints=ends, sender=sender, stale=Staleness(stale))


def test_a_node_that_publishes_is_named_and_its_type_counts():
    ends = (Endpoint("/a", Role.PUBLISHER, ("geometry_msgs/Point",)),)
    row = make([packet("/a", NODE, i) for i in range(3)], (node("/n", *ends, sender=NODE),))["/a"]
    assert (row.types, row.is_announced, row.senders) == (("geometry_msgs/Point",), True, ("/n",))
    assert (row.messages, row.rate, row.lost, row.loss) == (3, 10.0, 0, 0.0)
    assert row.age == 1.8


def test_a_program_that_is_no_node_is_named_by_its_process_else_by_its_address():
    rows = make([packet("A", PROGRAM), packet("B", FAR), packet("C", None)])
    assert rows["A"].senders == ("drive.py (pid 42)",)
    assert rows["B"].senders == ("10.9.8.7:3000",)
    assert rows["C"].senders == ("unknown sender",)


def test_what_is_announced_but_silent_has_a_row():
    ends = (Endpoint("/a", Role.PUBLISHER), Endpoint("/b", Role.SUBSCRIBER, ("std_msgs/String",)))
    rows = make([], (node("/n", *ends),))
    assert rows["/a"] == ChannelRow("/a", senders=("/n",))
    assert (rows["/b"].listeners, rows["/b"].types) == (("/n",), ("std_msgs/String",))
    assert rows["/b"].is_silent


def test_types_that_are_not_announced_are_all_that_the_fingerprint_may_mean():
    rows = make([packet("A", PROGRAM), packet("N", PROGRAM, payload=bytes(20))])
    assert {"geometry_msgs/Vector3", "geometry_msgs/Point"} <= set(rows["A"].types)
    assert not rows["A"].is_announced
    assert rows["N"].types == ()


def test_a_channel_that_names_its_type_has_that_one_where_it_can_be():
    channels = ("/a#geometry_msgs.Point", "/b#geometry_msgs.Vector3", "/c#std_msgs.String")
    rows = make([packet(channel, PROGRAM) for channel in channels])
    assert rows[channels[0]].types[0] == "geometry_msgs/Point"
    assert rows[channels[1]].types[0] == "geometry_msgs/Vector3"
    assert "std_msgs/String" not in rows[channels[2]].types


def test_loss_is_that_of_the_channels_senders_whatever_the_channel():
    numbers = [0, 1, 3, 4, 5, 7]
    sent = [packet("AB"[i % 2], PROGRAM, number) for i, number in enumerate(numbers)]
    rows = make([*sent, packet("C", FAR, 5)])
    assert (rows["A"].lost, rows["A"].loss) == (2, 0.25)
    assert (rows["B"].lost, rows["B"].loss) == (2, 0.25)
    assert (rows["C"].lost, rows["C"].loss) == (0, 0.0)


def test_loss_is_not_known_where_the_bus_numbers_nothing():
    assert make([packet("A", None)])["A"].lost is None
    assert make([packet("A", PROGRAM)], with_numbers=False)["A"].loss is None


def test_hidden_channels_and_looking_commands_are_left_out_unless_they_are_wanted():
    ends = (Endpoint("/a", Role.SUBSCRIBER),)
    nodes = (node("/n", Endpoint("/a", Role.PUBLISHER)), node("/_tool", *ends))
    packets = [packet("/_secret", PROGRAM)]
    assert list(make(packets, nodes)) == ["/a"]
    assert make(packets, nodes)["/a"].listeners == ()
    everything = make(packets, nodes, ChannelSelection(hidden=True))
    assert list(everything) == ["/_secret", "/a"]
    assert everything["/a"].listeners == ("/_tool",)


def test_only_the_wanted_channels_have_rows():
    packets = [packet(channel, PROGRAM) for channel in ("/a/x", "/ab", "/c/x", "POSE")]
    assert list(make(packets, selection=ChannelSelection(("/a",)))) == ["/a/x"]
    assert list(make(packets, selection=ChannelSelection(("*/x", "POSE")))) == [
        "/a/x",
        "/c/x",
        "POSE",
    ]


def test_a_stale_node_is_marked():
    stale = node("/n", Endpoint("/a", Role.PUBLISHER), stale="does not answer")
    assert make([], (stale,))["/a"].senders == ("/n (stale: does not answer)",)


def test_a_sender_that_others_have_long_replaced_is_not_named():
    old = packet("A", FAR)
    new = old._replace(sender=Sender("10.9.8.8", 1), time=old.time + 20 * S)
    assert make([old, new])["A"].senders == ("10.9.8.8:1",)


def test_channels_of_images_and_clouds_may_be_left_out_of_those_that_nodes_publish():
    kinds = ("Image", "PointCloud2", "CompressedImage", "LaserScan", "NoSuchType")
    ends = [Endpoint(f"/{kind}", Role.PUBLISHER, (f"sensor_msgs/{kind}",)) for kind in kinds]
    graph = Graph((node("/n", *ends, Endpoint("/untyped", Role.PUBLISHER)),))
    rows = ChannelRows(ChannelSelection(), names())
    assert len(rows.published(graph)) == 6
    assert rows.published(graph, large=False) == ["/LaserScan", "/NoSuchType", "/untyped"]
