"""The table's texts and order, and what is cut or left out for a narrow terminal."""

import pytest

from lcmtools.observe.channels.channel_report import to_lines as table
from lcmtools.observe.channels.columns import (
    COLUMNS,
    TableView,
    age_text,
    jitter_text,
    loss_text,
    rate_text,
    type_text,
)
from lcmtools.observe.channels.rows import ChannelRow, matching
from lcmtools.observe.channels.table import cut, width_of
from lcmtools.observe.reports.describe import size_text

ROWS = (
    ChannelRow(
        "/robot0/front_camera/depth/image_raw",
        ("sensor_msgs/Image",),
        is_announced=True,
        messages=30,
        bytes=30 * 614_400,
        rate=29.97,
        jitter=0.0031,
        bandwidth=18_413_568.0,
        lost=3,
        loss=0.02,
        senders=("/robot0/camera_driver", "viewer.py (pid 4711)"),
        listeners=("/robot0/obstacle_detector",),
        age=0.02,
    ),
    ChannelRow("POSE", messages=2, rate=1.0, bandwidth=24.0, lost=0, loss=0.0, age=0.5),
    ChannelRow("/quiet", ("std_msgs/String",), is_announced=True, listeners=("/monitor",)),
)


def test_the_whole_table_where_there_is_room():
    heading, camera, pose, quiet = table(ROWS, None)
    assert heading.split() == [name.upper() for name in ("channel", "type", "messages", "Hz")] + [
        "JITTER",
        "BANDWIDTH",
        "LOSS",
        "SENDERS",
        "LISTENERS",
    ]
    assert camera == (
        "/robot0/front_camera/depth/image_raw  sensor_msgs/Image        30  29.97  3.1 ms"
        "  18.4 MB/s  2.0%  /robot0/camera_driver, viewer.py (pid 4711)  /robot0/obstacle_detector"
    )
    assert pose == (
        "POSE                                  ?                         2   1.00       -"
        "     24 B/s     0  -                                            -"
    )
    assert quiet == (
        "/quiet                                std_msgs/String           0      -       -"
        "          -     -  -                                            /monitor"
    )


def test_on_eighty_columns_texts_are_cut_and_what_matters_least_is_left_out():
    assert table(ROWS, 80) == [
        "CHANNEL                    TYPE            HZ JITTER BANDWIDTH LOSS SENDERS",
        "/robot0/f…/depth/image_raw …/Image      29.97 3.1 ms 18.4 MB/s 2.0% /robot0/cam…",
        "POSE                       ?             1.00      -    24 B/s    0 -",
        "/quiet                     …/String         -      -         -    - -",
    ]


@pytest.mark.parametrize("room", [20, 42, 80, 120])
def test_no_line_is_wider_than_the_terminal_down_to_what_cannot_be_cut(room):
    assert max(map(width_of, table(ROWS, room))) <= max(room, 42)


def test_an_empty_table_is_its_heading():
    assert len(table((), 80)) == 1


def test_wide_characters_take_two_places():
    wide = (ChannelRow("温度センサー", senders=("x",)), ChannelRow("plain", senders=("y",)))
    lines = table(wide, None)
    assert width_of("温度") == 4
    assert width_of("e\u0301") == 1
    assert {width_of(line.rpartition("x")[0]) for line in lines[1:2]} == {
        width_of(line.rpartition("y")[0]) for line in lines[2:]
    }


@pytest.mark.parametrize(
    ("text", "width", "where", "expected"),
    [
        ("short", 5, "end", "short"),
        ("/a/long/name", 6, "end", "/a/lo…"),
        ("/a/long/name", 6, "middle", "/a…ame"),
        ("nav_msgs/Odometry", 12, "start", "…/Odometry"),
        ("nav_msgs/Odometry", 6, "start", "…metry"),
        ("anything", 0, "end", ""),
        ("温度センサー", 6, "end", "温度…"),
    ],
)
def test_texts_are_cut_where_they_say_least(text, width, where, expected):
    assert cut(text, width, where) == expected


def test_control_characters_are_escaped():
    assert "\x1b" not in "".join(table((ChannelRow("\x1b[2J"),), None))


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (0, "0 B"), (999, "999 B"), (1000, "1.00 KB"), (99_960, "100 KB"),
     (12_345_678, "12.3 MB"), (5e12, "5000 GB")],
)  # fmt: skip
def test_sizes_have_three_digits(value, text):
    assert size_text(value) == text


def test_numbers_are_written_as_short_as_they_may_be():
    assert [rate_text(v) for v in (None, 0.0, 0.2, 49.996, 12345.6)] == [
        "-", "0", "0.20", "50.00", "12346",
    ]  # fmt: skip
    assert [jitter_text(v) for v in (None, 0.0, 0.0123, 2.5)] == [
        "-",
        "0.0 ms",
        "12.3 ms",
        "2.50 s",
    ]
    assert [age_text(v) for v in (None, 0.04, 12.4, 300, 9000, 2e6)] == [
        "-", "0.0 s", "12 s", "5 min", "2 h", "23 d",
    ]  # fmt: skip


def test_a_loss_is_never_written_as_none():
    texts = [loss_text(v) for v in (None, 0.0, 1e-6, 0.034, 0.5, 1.0)]
    assert texts == ["-", "0", "0.1%", "3.4%", "50%", "100%"]


def test_a_type_by_fingerprint_says_how_many_others_it_may_be():
    types = ("geometry_msgs/Vector3", "geometry_msgs/Point", "own/Three")
    assert type_text(ChannelRow("A", types)) == "geometry_msgs/Vector3 +2"
    assert type_text(ChannelRow("A", types[:1])) == "geometry_msgs/Vector3"
    assert type_text(ChannelRow("A", types[:2], is_announced=True)) == ", ".join(types[:2])
    assert (type_text(ChannelRow("A", messages=1)), type_text(ChannelRow("A"))) == ("?", "-")


def test_every_column_has_a_key_of_its_own():
    letters = [column.letter for column in COLUMNS.values()]
    assert len(set(letters)) == len(letters)
    assert not set(letters) & set("qchI")


MIXED = (
    ChannelRow("/c", types=("std_msgs/String",), rate=1.0, messages=3, senders=("/talker",)),
    ChannelRow("/b", types=(), rate=50.0, messages=2, listeners=("/monitor",)),
    ChannelRow("/a", rate=None, messages=1),
    ChannelRow("/d", types=("std_msgs/Bool",), rate=50.4, messages=0),
)


def shown(view, *, steady=False):
    return [row.channel for row in view.rows(MIXED, steady=steady)]


def test_numbers_are_sorted_from_the_largest_and_what_has_none_is_last_either_way():
    assert shown(TableView("rate")) == ["/d", "/b", "/c", "/a"]
    assert shown(TableView("rate", inverted=True)) == ["/c", "/b", "/d", "/a"]
    assert shown(TableView("messages")) == ["/c", "/b", "/a", "/d"]


def test_texts_are_sorted_from_a():
    assert shown(TableView()) == ["/a", "/b", "/c", "/d"]
    assert shown(TableView("type")) == ["/d", "/c", "/a", "/b"]
    assert shown(TableView("channel", inverted=True)) == ["/d", "/c", "/b", "/a"]


def test_what_hardly_differs_keeps_its_place_on_the_screen():
    assert shown(TableView("rate"), steady=True) == ["/b", "/d", "/c", "/a"]


def test_a_filter_looks_at_channel_type_sender_and_listener_ignoring_case():
    found = {
        text: [r.channel for r in matching(MIXED, text)] for text in ("STD", "talk", "moni", "/b")
    }
    assert found == {"STD": ["/c", "/d"], "talk": ["/c"], "moni": ["/b"], "/b": ["/b", "/d"]}
    assert shown(TableView(text="nothing has this")) == []


def test_the_same_column_again_turns_the_order_round_and_another_begins_as_usual():
    view = TableView().sorted_by("rate")
    assert (view.column, view.inverted) == ("rate", False)
    assert view.sorted_by("rate").inverted
    assert not view.sorted_by("rate").sorted_by("loss").inverted


def test_next_and_previous_columns_go_round():
    assert TableView().moved(1).column == "type"
    assert TableView().moved(-1).column == "listeners"
    assert TableView("listeners").moved(1).column == "channel"
