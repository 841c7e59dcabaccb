"""Keys from terminals and scripts, and the velocities that they set."""

import pytest

from lcmtools.labs.nodes.driving.keyboard import KeyScript
from lcmtools.labs.nodes.driving.motion import HeldKey, Motion, Sliders
from lcmtools.terminal import split_keys


@pytest.mark.parametrize(
    ("data", "keys"),
    [
        (b"iQ,", ["i", "Q", ","]),
        (b"\x1b[A\x1b[B\x1b[C\x1b[D", ["up", "down", "right", "left"]),
        (b"\x1bOA", ["up"]),
        (b"\x1b[1;2D", ["left"]),
        (b"\x1b[15~i", ["i"]),  # F5
        (b"\x1b[Mabci", ["i"]),  # a mouse
        (b"\x1bi", ["i"]),  # Alt
        (b"\x1b", ["escape"]),
        (b"\x04", ["end"]),
        ("\u0448".encode(), ["\u0448"]),
    ],
)
def test_keys_are_found_in_what_a_terminal_sends(data, keys):
    assert split_keys(data, is_complete=True) == (keys, b"")


@pytest.mark.parametrize("end", [b"\x1b", b"\x1b[", b"\x1b[1;", b"\x1bO", b"\x1b[Ma"])
def test_beginning_of_a_sequence_waits_for_its_rest(end):
    assert split_keys(b"i" + end, is_complete=False) == (["i"], end)


def test_script_gives_keys_in_its_time():
    script = KeyScript()
    script.feed(b"i 2 jk # l 5\n.5 left up 1")
    script.feed(b"", is_last=True)
    assert script.due(10.0) == ["i"]
    assert script.due(11.99) == []
    assert script.due(12.0) == ["j", "k"]
    assert script.due(12.6) == ["left", "up"]
    assert not script.is_over(13.4)
    assert script.is_over(13.6)


def test_script_may_come_byte_by_byte():
    script = KeyScript()
    given = []
    for byte in b"i 1.5 . #k\nm":
        script.feed(bytes([byte]))
        given += script.due(0.0)
    assert given == ["i"]
    assert script.due(1.5) == [".", "m"]


def test_wait_that_comes_late_begins_when_it_comes():
    script = KeyScript()
    script.feed(b"i 1 j")
    assert script.due(0.0) + script.due(1.0) == ["i", "j"]
    script.feed(b" 1 k")
    assert script.due(100.0) == []
    assert script.due(101.0) == ["k"]


@pytest.mark.parametrize(
    ("keys", "velocity"),
    [
        ("i", (0.5, 0.0)),
        (",", (-0.5, 0.0)),
        ("j", (0.0, 1.0)),
        ("l", (0.0, -1.0)),
        ("u", (0.5, 1.0)),
        ("O", (0.5, -1.0)),
        ("m", (-0.5, -1.0)),
        (".", (-0.5, 1.0)),
        ("ik", (0.0, 0.0)),
        ("i?", (0.0, 0.0)),
        ("iq", (0.55, 0.0)),
        ("iqZ", (0.495, 0.0)),
        ("uw", (0.55, 1.0)),
        ("uX", (0.45, 1.0)),
        ("ue", (0.5, 1.1)),
        ("uC", (0.5, 0.9)),
        ("q", (0.0, 0.0)),
    ],
)
def test_keys_mean_what_the_table_says(keys, velocity):
    motion = Motion()
    for key in keys:
        motion = motion.after(key)
    assert (motion.forward, motion.turn_rate) == pytest.approx(velocity)


def test_speeds_stay_within_their_limits():
    motion = Motion(speed_limit=0.52, turn_limit=1.0).after("q").after("u")
    assert (motion.forward, motion.turn_rate) == (0.52, 1.0)
    assert "limit reached 0.52" in str(motion)


@pytest.mark.parametrize(
    ("keys", "velocity"),
    [
        (["up", "up", "left"], (0.2, 0.1)),
        (["w", "d"], (0.01, -0.01)),
        (["up"] * 15, (1.0, 0.0)),
        (["right"] * 40, (0.0, -3.0)),
        (["up", "left", "x"], (0.0, 0.1)),
        (["up", "left", "z"], (0.1, 0.0)),
        (["up", "left", " "], (0.0, 0.0)),
        (["up"] * 3 + ["down"] * 3, (0.0, 0.0)),
    ],
)
def test_sliders_move_as_the_keys_say(keys, velocity):
    sliders = Sliders()
    for key in keys:
        sliders = sliders.after(key)
    assert (sliders.forward, sliders.turn_rate) == velocity


def test_held_key_counts_until_it_should_have_come_again():
    hold = HeldKey()
    hold.press("i", 0)
    assert not hold.is_over(690_000_000)
    hold.press("i", 600_000_000)
    assert not hold.is_over(790_000_000)
    assert hold.is_over(800_000_000)
    hold.press("j", 800_000_000)
    assert not hold.is_over(1_490_000_000)
