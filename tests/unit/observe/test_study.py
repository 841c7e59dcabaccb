"""A close look at one channel: its fields as lines, and the history of its numbers."""

import math

from fixtures.says import assert_says

from lcmtools.messages.codec import encode
from lcmtools.observe.channels.field_lines import MOST_ELEMENTS, MOST_LINES, field_lines
from lcmtools.observe.channels.study import KEPT, Sparkline, Study, curve
from lcmtools.types.geometry_msgs import Point, PoseStamped, Twist, Vector3
from lcmtools.types.nav_msgs import Path
from lcmtools.types.sensor_msgs import Image, JointState, LaserScan
from lcmtools.types.std_msgs import Bool, Header
from lcmtools.wire.packet import Packet

S = 1_000_000_000
START = 1_795_000_000 * S


def scan(*ranges):
    message = LaserScan()
    message.ranges = ranges
    message.header.stamp.sec, message.header.stamp.nsec = 12, 5
    message.header.frame_id = "laser"
    return message


def shown(message, *toggled):
    return [(line.path, line.depth, line.text) for line in field_lines(message, toggled)]


def test_fields_are_lines_and_nested_ones_are_indented():
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
    assert [line.path for line in field_lines(message, ["linear"])][:2] == ["linear", "angular"]


def test_a_time_is_one_number_and_strings_are_none():
    lines = {line.path: line for line in field_lines(scan())}
    stamp, frame = lines["header.stamp"], lines["header.frame_id"]
    assert (stamp.text, stamp.number) == ("12.000000005", 12.000000005)
    assert (frame.text, frame.number) == ('"laser"', None)
    truth = Bool()
    truth.data = True
    assert [(line.text, line.number) for line in field_lines(truth)] == [("true", 1.0)]


def test_a_long_array_is_closed_and_shows_its_first_elements():
    lines = {line.path: line for line in field_lines(scan(*(i / 3 for i in range(360))))}
    ranges = lines["ranges"]
    assert ranges.text == "float32[360] 0, 0.3333, 0.6667, 1, 1.333, 1.667, 2, 2.333, …"
    assert (ranges.opens, ranges.is_open) == (True, False)
    assert "ranges[0]" not in lines
    assert not lines["intensities"].opens


def test_an_opened_array_shows_its_elements_up_to_a_hundred():
    lines = {line.path: line for line in field_lines(scan(*range(360)), ["ranges"])}
    assert lines["ranges[99]"].number == 99.0
    assert "ranges[100]" not in lines
    assert lines["ranges[]"].text == f"{360 - MOST_ELEMENTS} more"


def test_a_short_array_is_open_until_it_is_closed():
    state = JointState()
    state.name, state.velocity = ["left", "right"], (1.0, 2.0)
    assert ("velocity[1]", 1, "2.0") in shown(state)
    assert ("name[0]", 1, '"left"') in shown(state)
    closed = shown(state, "velocity", "name")
    assert ("velocity", 0, "float64[2] 1, 2") in closed
    assert ("name", 0, 'string[2] "left", "right"') in closed


def test_bytes_are_shown_in_hexadecimal_and_can_be_opened():
    image = Image()
    image.data = bytes(range(200, 240))
    text = {path: text for path, _, text in shown(image)}["data"]
    assert text == "uint8[40] c8 c9 ca cb cc cd ce cf d0 d1 d2 d3 d4 d5 d6 d7 …"
    assert ("data[39]", 1, "239") in shown(image, "data")
    image.data = b"\x01\x02"
    assert ("data[1]", 1, "2") not in shown(image)
    assert ("data[1]", 1, "2") in shown(image, "data")


def test_a_message_without_end_has_so_many_lines_and_no_more():
    path = Path()
    path.poses = [PoseStamped() for _ in range(5000)]
    opened = field_lines(path, ["poses", *(f"poses[{i}].header" for i in range(3))])
    assert len(opened) <= MOST_LINES
    assert len(field_lines(path)) < 10


def test_a_long_text_is_cut():
    header = Header()
    header.frame_id = "x" * 1000
    text = {path: text for path, _, text in shown(header)}["frame_id"]
    assert text.endswith('x" … 1000 characters')
    assert len(text) < 240


def packet(message, time, channel="A"):
    payload = message if isinstance(message, bytes) else encode(message)
    return Packet(channel, payload, START + round(time * S))


def vector(x):
    message = Vector3()
    message.x = x
    return message


def test_numbers_are_kept_with_their_times():
    study = Study("A")
    for i in range(4):
        study.add_packet(packet(vector(i), i * 0.1))
    study.add_packet(packet(vector(99), 0.4, "B"))
    assert study.samples("x") == [(START + i * S // 10, float(i)) for i in range(4)]
    assert study.samples("nothing") == []
    state = study.state()
    assert (state.messages, state.decoded, state.problem) == (4, 4, "")
    assert state.lines[0].number == 3.0


def test_what_comes_too_fast_is_decoded_now_and_then():
    study = Study("A")
    for i in range(1000):
        study.add_packet(packet(vector(i), i / 1000))
    state = study.state()
    assert state.messages == 1000
    assert 50 <= state.decoded <= 60


def test_what_comes_fifty_times_a_second_is_all_decoded_though_unevenly():
    study = Study("A")
    for i in range(50):
        study.add_packet(packet(vector(i), i / 50 + (0.008 if i % 2 else 0.0)))
    assert study.state().decoded >= 49


def test_a_large_message_is_decoded_a_few_times_a_second():
    image = Image()
    image.data = bytes(300_000)
    study = Study("A")
    for i in range(30):
        study.add_packet(packet(image, i / 30))
    assert study.state().decoded <= 5
    assert study.state().size > 300_000


def test_the_announced_type_counts_and_the_others_are_named():
    for announced, expected in (("geometry_msgs/Point", "geometry_msgs/Point"), ("x/Y", None)):
        study = Study("A", (announced,))
        study.add_packet(packet(Point(), 0))
        state = study.state()
        assert state.type == (expected or "geometry_msgs/Vector3")
        assert state.type not in state.others
        assert state.others


def test_what_cannot_be_decoded_says_why_and_shows_its_bytes():
    study = Study("A")
    study.add_packet(packet(b"abc", 0))
    assert_says(study.state().problem, "too short")
    study.add_packet(packet(bytes(range(100)), 1))
    assert study.state().problem == "unknown type, fingerprint 0x0001020304050607"
    study.add_packet(packet(encode(vector(1))[:-1], 2))
    assert study.state().problem.startswith("broken geometry_msgs/Vector3")
    study.add_packet(packet(vector(2), 3))
    assert study.state().problem == ""


def test_a_head_of_a_large_message_is_counted_and_not_decoded():
    study = Study("A")
    study.add_packet(packet(vector(1), 0)._replace(whole_bytes=5000))
    assert (study.state().messages, study.state().decoded, study.state().lines) == (1, 0, ())


def test_only_so_much_is_kept_and_clear_forgets_it():
    study = Study("A")
    for i in range(KEPT + 10):
        study.add_packet(packet(vector(i), i))
    assert len(study.samples("x")) == KEPT
    assert study.samples("x")[-1][1] == KEPT + 9
    study.clear()
    assert study.samples("x") == []
    assert study.state().lines


def test_opened_elements_are_kept_from_then_on():
    study = Study("A")
    study.add_packet(packet(scan(*range(20)), 0))
    study.toggle("ranges")
    assert study.state().lines[-3].path.startswith("ranges")
    study.add_packet(packet(scan(*range(20)), 1))
    assert len(study.samples("ranges[7]")) == 1
    study.toggle("ranges")
    assert "ranges[7]" not in [line.path for line in study.state().lines]


def bars(*values, count=8):
    samples = [(i * S, value) for i, value in enumerate(values)]
    return curve(samples, (len(values) - 1) * S, count, S)


def test_a_bar_is_the_mean_of_its_stretch_of_time_scaled_to_the_range():
    assert bars(0, 1, 2, 3, 4) == Sparkline((0.0, 0.25, 0.5, 0.75, 1.0), 0, 4)
    samples = [(0, 0.0), (S // 2, 4.0), (S, 4.0), (2 * S, 0.0)]
    assert curve(samples, 2 * S, 3, S) == Sparkline((0.5, 1.0, 0.0), 0.0, 4.0)


def test_a_constant_is_flat_also_where_a_mean_is_rounded():
    tenths = [(i * S // 10, 0.1) for i in range(80)]
    assert curve(tenths, 8 * S - 1, 8, S) == Sparkline((0.0,) * 8, 0.1, 0.1)


def test_a_stretch_without_samples_has_the_bar_before():
    assert curve([(0, 1.0), (2 * S, 2.0)], 4 * S, 5, S).bars == (0.0, 0.0, 1.0, 1.0, 1.0)
    assert curve([(0, 1.0), (8 * S, 2.0)], 9 * S, 4, S).bars == (0.0, 0.0, 1.0, 1.0)


def test_bars_do_not_change_while_time_goes_by_within_one():
    samples = [(i * S // 7, float(i % 5)) for i in range(70)]
    first, second = (curve(samples, 10 * S + extra, 8, S) for extra in (0, S // 2))
    assert first == second


def test_a_curve_begins_with_the_first_finite_number():
    assert bars(math.nan, math.inf, 1, 2, count=4) == Sparkline((0.0, 1.0), 1, 2)
    assert bars(math.nan) == curve([], 0, 3, S) == Sparkline()


def test_the_largest_numbers_do_no_harm():
    assert bars(-1.7e308, 1.7e308, count=2) == Sparkline((0.0, 1.0), -1.7e308, 1.7e308)
