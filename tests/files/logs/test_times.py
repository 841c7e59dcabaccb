"""Logs whose times go back, stand still, or lie before 1970."""

import re
from itertools import pairwise

import pytest
from fixtures.says import assert_says
from fixtures.wire import encode_event

import lcmtools.bag
from lcmtools.bag.player import Player
from lcmtools.bag.playlist import Choice, Playlist
from lcmtools.messages.codec import encode
from lcmtools.types.builtin_interfaces import Time
from lcmtools.wire.packet import Packet

S = 1_000_000_000
T = 1_795_000_000  # [s]


def log(path, *times):
    events = (
        encode_event(number, Packet("/a", encode(Time()), round((T + time) * S)))
        for number, time in enumerate(times)
    )
    path.write_bytes(b"".join(events))
    return str(path)


def due(player, playlist):
    """When messages are due, and the time that /clock has then, both [s]."""
    found, now = [], 0
    while not player.is_over:
        now += round(player.wait(now) * S)
        clock = playlist.recorded_time(player.time(now))
        assert player.pop_due(now)
        found.append((round(now / S, 6), round(clock / S - T, 6)))
    return found


@pytest.mark.parametrize("time", [0, -T, -T - 1000.25])  # now, 1970, and before
def test_a_rate_needs_time(time, cli, tmp_path):
    path = log(tmp_path / "one", *[time] * 3)
    for verb, noun in (("hz", "rate"), ("bw", "bandwidth")):
        result = cli(verb, "-b", path, "/a")
        assert_says(result.err, "all messages on /a have the same time", f"a {noun} has no meaning")
        assert result.out == ""
        assert cli(verb, "-b", path, "/a", "--json").out == ""


def test_times_before_1970_are_right(cli, tmp_path):
    path = log(tmp_path / "old", *(-T - 1000.25 + number / 4 for number in range(5)))
    assert "average rate: 4.000" in cli("hz", "-b", path, "/a").ok()
    assert "average: 80.00B/s" in cli("bw", "-b", path, "/a").ok()
    assert_says(cli("bag", "info", path).ok(), "19.750 (-1000.250)", "20.750 (-999.250)")
    with lcmtools.bag.open(path) as opened:
        assert opened.to_numpy("/a")["%time"].tolist() == [
            -1_000_250_000_000 + number * S // 4 for number in range(5)
        ]


BACK = (3600, 3600.5, 3601, 0, 0.5, 1)


@pytest.mark.parametrize(
    ("times", "rate", "seconds"),
    [
        (BACK, 1, (0, 0.5, 1, 1, 1.5, 2)),
        (BACK, 2, (0, 0.25, 0.5, 0.5, 0.75, 1)),
        ((0, 1, 100, 101, 5, 6), 1, (0, 1, 100, 101, 101, 102)),
        ((100, 200, 0, 10, 5, 20), 1, (0, 100, 100, 110, 110, 120)),  # and a late message
        ((10, 11, -T, 12), 1, (0, 1, 1, 2)),  # a single time of 0
        ((3600, 0, 3600.1, 0.1, 3600.2, 0.2), 1, (0, 0, 0.1, 0.1, 0.2, 0.2)),  # two clocks
        ((0, 1, 0.5, 2), 1, (0, 1, 1, 2.5)),  # a little: a late message
    ],
)
def test_after_a_step_back_it_goes_on_at_once(times, rate, seconds, tmp_path):
    said = list[str]()
    with Playlist([log(tmp_path / "back", *times)], Choice(), said.append) as playlist:
        player = Player(playlist.messages, playlist.span, rate=rate)
        found = due(player, playlist)
    assert tuple(now for now, _ in found) == seconds
    steps = {now for now, after in pairwise(seconds) if now == after}
    for (now, clock), recorded in zip(found, times, strict=True):
        assert clock == recorded or now in steps or 0.5 in times[2:3]
    (line,) = said
    assert_says(line, "the times of", "go back", "lcmtools bag sort")


def test_a_place_in_such_a_log_is_found(tmp_path):
    with Playlist([log(tmp_path / "back", *BACK)], Choice()) as playlist:
        start, end = playlist.span
        player = Player(playlist.messages, playlist.span)
        assert player.position(0).length == 2
        player.seek(start + round(1.2 * S), 0)
        assert due(player, playlist) == [(0.3, 0.5), (0.8, 1)]
        player.seek(start + round(0.2 * S), 0)
        assert len(due(player, playlist)) == 5
        assert [one.time for one in playlist.latest(["/a"], end)] == [end]
        assert sum(playlist.histogram(10)) == 6


def test_the_step_is_found_in_an_indexed_log(cli, tmp_path):
    path = log(tmp_path / "back", *BACK)
    cli("bag", "reindex", path).ok()
    with Playlist([path], Choice()) as playlist:
        assert len(due(Player(playlist.messages, playlist.span), playlist)) == 6


def test_a_log_whose_times_go_back_an_hour_is_played_in_seconds(cli, bus_url, tmp_path):
    path = log(tmp_path / "back", *(time / 10 if time < 100 else time for time in BACK))
    result = cli("bag", "play", path, env={"LCM_DEFAULT_URL": bus_url})
    assert_says(result.err, "go back, by up to 1h 00m")
    played = re.search(r"6 messages in ([\d.]+) s", result.err)
    assert played
    assert 1.1 <= float(played[1]) < 60.0
