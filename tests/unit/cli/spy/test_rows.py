"""The rows of the table: types, senders, listeners and loss, as far as they are known."""

from lcmtools.bus.processes import Process, UdpSocket
from lcmtools.cli.spy.view import View
from lcmtools.graph.builder import GraphBuilder
from lcmtools.graph.model import Endpoint, Graph, Node, Role, Staleness
from lcmtools.messages.codec import encode
from lcmtools.observe.activity import Activity
from lcmtools.observe.channels import Row, Rows, Wanted, losses, matching
from lcmtools.observe.senders import SenderNames, SocketTable
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.wire.packet import Packet, Sender
from lcmtools.wire.sequence import Sequence

S = 1_000_000_000
NOW = 1_795_000_000 * S
NODE = Sender("127.0.0.1", 1000)
PROGRAM = Sender("127.0.0.1", 2000)
FAR = Sender("10.9.8.7", 3000)
POINT = encode(Vector3())


def names() -> SenderNames:
    process = Process(42, "/usr/bin/python3 -u /home/me/drive.py --fast")
    rows = {1: UdpSocket("127.0.0.1", 2000, 1, 0, 0)}
    return SenderNames(lambda _: SocketTable(rows, {1: process}))


def packet(channel: str, sender: Sender | None, seqno: int = 0, payload: bytes = POINT) -> Packet:
    return Packet(channel, payload, NOW + seqno * S // 10, sender, seqno)


def make(
    packets: list[Packet],
    nodes: tuple[Node, ...] = (),
    wanted: Wanted = Wanted(),  # noqa: B008 - frozen
    *,
    with_numbers: bool = True,
) -> dict[str, Row]:
    """The rows of a bus, by channel."""
    activity, builder = Activity(), GraphBuilder()
    numbers: dict[Sender, Sequence] = {}
    for one in packets:
        activity.hear(one)
        builder.hear(one)
        if one.sender is not None and one.seqno is not None:
            numbers.setdefault(one.sender, Sequence()).add(one.seqno)
    now = NOW + 2 * S
    graph = Graph(nodes, builder.snapshot(now).traffic, now)
    lost = losses(numbers) if with_numbers else None
    rows = Rows(wanted, names()).make(graph, activity, lost, now)
    return {row.channel: row for row in rows}


def node(name: str, *ends: Endpoint, sender: Sender | None = None, stale: str = "") -> Node:
    return Node(name, name, "h", 7, endpoints=ends, sender=sender, stale=Staleness(stale))


def test_a_node_that_publishes_is_named_and_its_type_counts() -> None:
    ends = (Endpoint("/a", Role.PUBLISHER, ("geometry_msgs/Point",)),)
    row = make([packet("/a", NODE, i) for i in range(3)], (node("/n", *ends, sender=NODE),))["/a"]
    assert (row.types, row.is_announced, row.senders) == (("geometry_msgs/Point",), True, ("/n",))
    assert (row.messages, row.rate, row.lost, row.loss) == (3, 10.0, 0, 0.0)
    assert row.age == 1.8


def test_a_program_that_is_no_node_is_named_by_its_process_else_by_its_address() -> None:
    rows = make([packet("A", PROGRAM), packet("B", FAR), packet("C", None)])
    assert rows["A"].senders == ("drive.py (pid 42)",)
    assert rows["B"].senders == ("10.9.8.7:3000",)
    assert rows["C"].senders == ("unknown sender",)


def test_what_is_announced_but_silent_has_a_row() -> None:
    ends = (Endpoint("/a", Role.PUBLISHER), Endpoint("/b", Role.SUBSCRIBER, ("std_msgs/String",)))
    rows = make([], (node("/n", *ends),))
    assert rows["/a"] == Row("/a", senders=("/n",))
    assert (rows["/b"].listeners, rows["/b"].types) == (("/n",), ("std_msgs/String",))
    assert rows["/b"].is_silent


def test_types_that_are_not_announced_are_all_that_the_fingerprint_may_mean() -> None:
    rows = make([packet("A", PROGRAM), packet("N", PROGRAM, payload=bytes(20))])
    assert {"geometry_msgs/Vector3", "geometry_msgs/Point"} <= set(rows["A"].types)
    assert not rows["A"].is_announced
    assert rows["N"].types == ()


def test_a_channel_that_names_its_type_has_that_one_where_it_can_be() -> None:
    channels = ("/a#geometry_msgs.Point", "/b#geometry_msgs.Vector3", "/c#std_msgs.String")
    rows = make([packet(channel, PROGRAM) for channel in channels])
    assert rows[channels[0]].types[0] == "geometry_msgs/Point"
    assert rows[channels[1]].types[0] == "geometry_msgs/Vector3"
    assert "std_msgs/String" not in rows[channels[2]].types


def test_loss_is_that_of_the_channels_senders_whatever_the_channel() -> None:
    numbers = [0, 1, 3, 4, 5, 7]
    sent = [packet("AB"[i % 2], PROGRAM, number) for i, number in enumerate(numbers)]
    rows = make([*sent, packet("C", FAR, 5)])
    assert (rows["A"].lost, rows["A"].loss) == (2, 0.25)
    assert (rows["B"].lost, rows["B"].loss) == (2, 0.25)
    assert (rows["C"].lost, rows["C"].loss) == (0, 0.0)


def test_loss_is_not_known_where_the_bus_numbers_nothing() -> None:
    assert make([packet("A", None)])["A"].lost is None
    assert make([packet("A", PROGRAM)], with_numbers=False)["A"].loss is None


def test_a_port_that_several_programs_share_tells_no_loss() -> None:
    shared = [packet("A", PROGRAM, number) for number in (0, 5, 0, 5, 0, 5)]
    assert make(shared)["A"].lost is None


def test_losses_count_from_where_they_were_cleared() -> None:
    numbers = {FAR: Sequence()}
    for number in (0, 2, 3):
        numbers[FAR].add(number)
    before = losses(numbers)
    for number in (4, 6, 7):
        numbers[FAR].add(number)
    assert losses(numbers, before) == {FAR: (3, 1)}


def test_hidden_channels_and_looking_commands_are_left_out_unless_they_are_wanted() -> None:
    ends = (Endpoint("/a", Role.SUBSCRIBER),)
    nodes = (node("/n", Endpoint("/a", Role.PUBLISHER)), node("/_tool", *ends))
    packets = [packet("/_secret", PROGRAM)]
    assert list(make(packets, nodes)) == ["/a"]
    assert make(packets, nodes)["/a"].listeners == ()
    everything = make(packets, nodes, Wanted(hidden=True))
    assert list(everything) == ["/_secret", "/a"]
    assert everything["/a"].listeners == ("/_tool",)


def test_only_the_wanted_channels_have_rows() -> None:
    packets = [packet(channel, PROGRAM) for channel in ("/a/x", "/ab", "/c/x", "POSE")]
    assert list(make(packets, wanted=Wanted(("/a",)))) == ["/a/x"]
    assert list(make(packets, wanted=Wanted(("*/x", "POSE")))) == ["/a/x", "/c/x", "POSE"]


def test_a_stale_node_is_marked() -> None:
    stale = node("/n", Endpoint("/a", Role.PUBLISHER), stale="does not answer")
    assert make([], (stale,))["/a"].senders == ("/n (stale: does not answer)",)


def test_a_sender_that_others_have_long_replaced_is_not_named() -> None:
    old = packet("A", FAR)
    new = old._replace(sender=Sender("10.9.8.8", 1), time=old.time + 20 * S)
    assert make([old, new])["A"].senders == ("10.9.8.8:1",)


ROWS = (
    Row("/c", types=("std_msgs/String",), rate=1.0, messages=3, senders=("/talker",)),
    Row("/b", types=(), rate=50.0, messages=2, listeners=("/ears",)),
    Row("/a", rate=None, messages=1),
    Row("/d", types=("std_msgs/Bool",), rate=50.4, messages=0),
)


def shown(view: View, *, steady: bool = False) -> list[str]:
    return [row.channel for row in view.rows(ROWS, steady=steady)]


def test_numbers_are_sorted_from_the_largest_and_what_has_none_is_last_either_way() -> None:
    assert shown(View("rate")) == ["/d", "/b", "/c", "/a"]
    assert shown(View("rate", inverted=True)) == ["/c", "/b", "/d", "/a"]
    assert shown(View("messages")) == ["/c", "/b", "/a", "/d"]


def test_texts_are_sorted_from_a() -> None:
    assert shown(View()) == ["/a", "/b", "/c", "/d"]
    assert shown(View("type")) == ["/d", "/c", "/a", "/b"]
    assert shown(View("channel", inverted=True)) == ["/d", "/c", "/b", "/a"]


def test_what_hardly_differs_keeps_its_place_on_the_screen() -> None:
    assert shown(View("rate"), steady=True) == ["/b", "/d", "/c", "/a"]


def test_a_filter_looks_at_channel_type_sender_and_listener_in_whatever_case() -> None:
    found = {
        text: [r.channel for r in matching(ROWS, text)] for text in ("STD", "talk", "ear", "/b")
    }
    assert found == {"STD": ["/c", "/d"], "talk": ["/c"], "ear": ["/b"], "/b": ["/b", "/d"]}
    assert shown(View(text="nothing has this")) == []


def test_the_same_column_again_turns_the_order_round_and_another_begins_as_usual() -> None:
    view = View().sorted_by("rate")
    assert (view.column, view.inverted) == ("rate", False)
    assert view.sorted_by("rate").inverted
    assert not view.sorted_by("rate").sorted_by("loss").inverted


def test_next_and_previous_columns_go_round() -> None:
    assert View().moved(1).column == "type"
    assert View().moved(-1).column == "listeners"
    assert View("listeners").moved(1).column == "channel"
