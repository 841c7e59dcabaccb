"""One channel looked at closely: its fields as lines, and what its numbers have been."""

from lcmtools.cli.spy.closeup import Closeup
from lcmtools.cli.spy.numbers import MOST_ELEMENTS, MOST_LINES, lines_of
from lcmtools.messages.codec import encode
from lcmtools.messages.registry import Message
from lcmtools.observe.channels import Row
from lcmtools.observe.study import KEPT, Study
from lcmtools.types.geometry_msgs import Point, PoseStamped, Twist, Vector3
from lcmtools.types.nav_msgs import Path
from lcmtools.types.sensor_msgs import Image, JointState, LaserScan
from lcmtools.types.std_msgs import Bool, Header
from lcmtools.wire.packet import Packet

S = 1_000_000_000
START = 1_795_000_000 * S


def scan(*ranges: float) -> LaserScan:
    message = LaserScan()
    message.ranges = ranges
    message.header.stamp.sec, message.header.stamp.nsec = 12, 5
    message.header.frame_id = "laser"
    return message


def shown(message: Message, *toggled: str) -> list[tuple[str, int, str]]:
    return [(line.path, line.depth, line.text) for line in lines_of(message, toggled)]


def test_fields_are_lines_and_nested_ones_are_indented() -> None:
    message = Twist()
    message.linear.x = 0.5
    assert shown(message) == [
        ("linear", 0, ""),
        ("linear.x", 1, "0.5"),
        ("linear.y", 1, "0.0"),
        ("linear.z", 1, "0.0"),
        ("angular", 0, ""),
        ("angular.x", 1, "0.0"),
        ("angular.y", 1, "0.0"),
        ("angular.z", 1, "0.0"),
    ]
    assert [line.path for line in lines_of(message, ["linear"])][:2] == ["linear", "angular"]


def test_a_time_is_one_number_and_strings_are_none() -> None:
    lines = {line.path: line for line in lines_of(scan())}
    stamp, frame = lines["header.stamp"], lines["header.frame_id"]
    assert (stamp.text, stamp.number) == ("12.000000005", 12.000000005)
    assert (frame.text, frame.number) == ('"laser"', None)
    truth = Bool()
    truth.data = True
    assert [(line.text, line.number) for line in lines_of(truth)] == [("true", 1.0)]


def test_a_long_array_is_closed_and_shows_its_first_elements() -> None:
    lines = {line.path: line for line in lines_of(scan(*(i / 3 for i in range(360))))}
    ranges = lines["ranges"]
    assert ranges.text == "float32[360] 0, 0.3333, 0.6667, 1, 1.333, 1.667, 2, 2.333, …"
    assert (ranges.opens, ranges.is_open) == (True, False)
    assert "ranges[0]" not in lines
    assert not lines["intensities"].opens


def test_an_opened_array_shows_its_elements_up_to_a_hundred() -> None:
    lines = {line.path: line for line in lines_of(scan(*range(360)), ["ranges"])}
    assert lines["ranges[99]"].number == 99.0
    assert "ranges[100]" not in lines
    assert lines["ranges[]"].text == f"{360 - MOST_ELEMENTS} more"


def test_a_short_array_is_open_until_it_is_closed() -> None:
    state = JointState()
    state.name, state.velocity = ["left", "right"], (1.0, 2.0)
    assert ("velocity[1]", 1, "2.0") in shown(state)
    assert ("name[0]", 1, '"left"') in shown(state)
    closed = shown(state, "velocity", "name")
    assert ("velocity", 0, "float64[2] 1, 2") in closed
    assert ("name", 0, 'string[2] "left", "right"') in closed


def test_bytes_are_shown_in_hexadecimal_and_can_be_opened() -> None:
    image = Image()
    image.data = bytes(range(200, 240))
    text = {path: text for path, _, text in shown(image)}["data"]
    assert text == "uint8[40] c8 c9 ca cb cc cd ce cf d0 d1 d2 d3 d4 d5 d6 d7 …"
    assert ("data[39]", 1, "239") in shown(image, "data")
    image.data = b"\x01\x02"
    assert ("data[1]", 1, "2") not in shown(image)
    assert ("data[1]", 1, "2") in shown(image, "data")


def test_a_message_without_end_has_so_many_lines_and_no_more() -> None:
    path = Path()
    path.poses = [PoseStamped() for _ in range(5000)]
    opened = lines_of(path, ["poses", *(f"poses[{i}].header" for i in range(3))])
    assert len(opened) <= MOST_LINES
    assert len(lines_of(path)) < 10


def test_a_long_text_is_cut() -> None:
    header = Header()
    header.frame_id = "x" * 1000
    text = {path: text for path, _, text in shown(header)}["frame_id"]
    assert text.endswith('x" … 1000 characters')
    assert len(text) < 240


def packet(message: Message | bytes, time: float, channel: str = "A") -> Packet:
    payload = message if isinstance(message, bytes) else encode(message)
    return Packet(channel, payload, START + round(time * S))


def vector(x: float) -> Vector3:
    message = Vector3()
    message.x = x
    return message


def test_numbers_are_kept_with_their_times() -> None:
    study = Study("A")
    for i in range(4):
        study.hear(packet(vector(i), i * 0.1))
    study.hear(packet(vector(99), 0.4, "B"))
    assert study.samples("x") == [(START + i * S // 10, float(i)) for i in range(4)]
    assert study.samples("nothing") == []
    look = study.look()
    assert (look.messages, look.decoded, look.problem) == (4, 4, "")
    assert look.lines[0].number == 3.0


def test_what_comes_too_fast_is_decoded_now_and_then() -> None:
    study = Study("A")
    for i in range(1000):
        study.hear(packet(vector(i), i / 1000))
    look = study.look()
    assert look.messages == 1000
    assert 50 <= look.decoded <= 60


def test_what_comes_fifty_times_a_second_is_all_decoded_though_unevenly() -> None:
    study = Study("A")
    for i in range(50):
        study.hear(packet(vector(i), i / 50 + (0.008 if i % 2 else 0.0)))
    assert study.look().decoded >= 49


def test_a_large_message_is_decoded_a_few_times_a_second() -> None:
    image = Image()
    image.data = bytes(300_000)
    study = Study("A")
    for i in range(30):
        study.hear(packet(image, i / 30))
    assert study.look().decoded <= 5
    assert study.look().size > 300_000


def test_the_announced_type_counts_and_the_others_are_named() -> None:
    for announced, expected in (("geometry_msgs/Point", "geometry_msgs/Point"), ("x/Y", None)):
        study = Study("A", (announced,))
        study.hear(packet(Point(), 0))
        look = study.look()
        assert look.type == (expected or "geometry_msgs/Vector3")
        assert look.type not in look.others
        assert look.others


def test_what_cannot_be_decoded_says_why_and_shows_its_bytes() -> None:
    study = Study("A")
    study.hear(packet(b"abc", 0))
    assert study.look().problem == "3 bytes are too few for an LCM message"
    study.hear(packet(bytes(range(100)), 1))
    assert study.look().problem == "unknown type, fingerprint 0x0001020304050607"
    study.hear(packet(encode(vector(1))[:-1], 2))
    assert study.look().problem.startswith("broken geometry_msgs/Vector3")
    study.hear(packet(vector(2), 3))
    assert study.look().problem == ""


def test_a_head_of_a_large_message_is_counted_and_not_decoded() -> None:
    study = Study("A")
    study.hear(packet(vector(1), 0)._replace(whole_bytes=5000))
    assert (study.look().messages, study.look().decoded, study.look().lines) == (1, 0, ())


def test_only_so_much_is_kept_and_clear_forgets_it() -> None:
    study = Study("A")
    for i in range(KEPT + 10):
        study.hear(packet(vector(i), i))
    assert len(study.samples("x")) == KEPT
    assert study.samples("x")[-1][1] == KEPT + 9
    study.clear()
    assert study.samples("x") == []
    assert study.look().lines


def test_opened_elements_are_kept_from_then_on() -> None:
    study = Study("A")
    study.hear(packet(scan(*range(20)), 0))
    study.toggle("ranges")
    assert study.look().lines[-3].path.startswith("ranges")
    study.hear(packet(scan(*range(20)), 1))
    assert len(study.samples("ranges[7]")) == 1
    study.toggle("ranges")
    assert "ranges[7]" not in [line.path for line in study.look().lines]


def closeup(study: Study, row: Row | None = None) -> Closeup:
    return Closeup(row or Row("A"), study.look())


def text_of(pieces: list[tuple[str, str]]) -> str:
    return "".join(text for text, _ in pieces).rstrip()


def test_a_number_has_its_curve_and_its_range_beside_it() -> None:
    study = Study("A")
    for i in range(8):
        study.hear(packet(vector(i), i * 0.5))
    found = closeup(study)
    assert found.keys == ["x", "y", "z"]
    line = text_of(found.body(0, 80, study.samples))
    assert line.startswith("  x")
    assert line.endswith("▁▂▃▄▅▆▇█  0 .. 7")
    assert text_of(found.body(1, 80, study.samples)).endswith("▄▄▄▄▄▄▄▄  constant")
    assert text_of(found.body(0, 40, study.samples)).split() == ["x", "7.0"]


def test_numbers_that_hardly_differ_say_by_how_much() -> None:
    study = Study("A")
    for i in range(4):
        study.hear(packet(vector(9.81 + i * 1e-12), i * 0.5))
    assert text_of(closeup(study).body(0, 100, study.samples)).endswith("9.81, within 3e-12")


def test_what_is_known_of_a_channel_stands_above_its_message() -> None:
    study = Study("A")
    study.hear(packet(vector(1), 0))
    row = Row("A", rate=10.0, jitter=0.002, bandwidth=320.0, lost=3, loss=0.1, messages=27,
              senders=("drive.py (pid 42)",), age=0.5)  # fmt: skip
    head = [text_of(line) for line in closeup(study, row).head(100)]
    assert head == [
        "A  10.00 Hz  jitter 2.0 ms  320 B/s  loss 10% of its senders' messages (3)  27 messages",
        "type        geometry_msgs/Vector3 by its fingerprint, or geometry_msgs/Point",
        "fingerprint 0xae7e5fba5eeca11e",
        "senders     drive.py (pid 42)",
        "listeners   -",
        "message     32 B, 0.5 s ago",
    ]


def test_what_cannot_be_decoded_is_shown_in_hexadecimal() -> None:
    study = Study("A")
    study.hear(packet(bytes(range(60, 80)), 0))
    found = closeup(study)
    assert text_of(found.head(80)[-1]) == "unknown type, fingerprint 0x3c3d3e3f40414243"
    assert [text_of(found.body(i, 80, study.samples)) for i in range(len(found.keys))] == [
        "     0  3c 3d 3e 3f 40 41 42 43 44 45 46 47 48 49 4a 4b  <=>?@ABCDEFGHIJK",
        "    16  4c 4d 4e 4f                                      LMNO",
    ]


def test_before_the_first_message_it_says_so() -> None:
    head = [text_of(line) for line in closeup(Study("A"), Row("A")).head(80)]
    assert "message     none since it is looked at closely" in head
    assert "type        unknown" in head
