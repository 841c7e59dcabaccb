"""Curves of text: every bar and dot where the number is."""

import math

import pytest

from lcmtools.cli.spy.sparkline import number_text, plot, sparkline

S = 1_000_000_000


def bars(*values: float, width: int = 8) -> str:
    samples = [(i * S, value) for i, value in enumerate(values)]
    return sparkline(samples, (len(values) - 1) * S, width, S)


def test_a_bar_is_as_high_as_the_number_between_the_least_and_the_most() -> None:
    assert bars(0, 1, 2, 3, 4, 5, 6, 7) == "▁▂▃▄▅▆▇█"
    assert bars(7, 0) == "      █▁"


def test_what_is_constant_is_flat_also_where_a_mean_is_rounded() -> None:
    assert bars(3, 3, 3) == "     ▄▄▄"
    tenths = [(i * S // 10, 0.1) for i in range(80)]
    assert sparkline(tenths, 8 * S - 1, 8, S) == "▄" * 8


def test_a_bar_is_the_mean_of_its_stretch_of_time() -> None:
    samples = [(0, 0.0), (S // 2, 4.0), (S, 4.0), (2 * S, 0.0)]
    assert sparkline(samples, 2 * S, 3, S) == "▅█▁"


def test_where_nothing_came_the_bar_before_goes_on_also_from_beyond_the_left_end() -> None:
    assert sparkline([(0, 1.0), (2 * S, 2.0)], 4 * S, 5, S) == "▁▁███"
    assert sparkline([(0, 1.0), (8 * S, 2.0)], 9 * S, 4, S) == "▁▁██"


def test_bars_do_not_change_while_time_goes_by_within_one() -> None:
    samples = [(i * S // 7, float(i % 5)) for i in range(70)]
    first, second = (sparkline(samples, 10 * S + extra, 8, S) for extra in (0, S // 2))
    assert first == second


def test_what_is_no_number_leaves_a_gap_only_at_the_beginning() -> None:
    assert bars(math.nan, math.inf, 1, 2, width=4) == "  ▁█"
    assert bars(math.nan, width=3) == "   "
    assert sparkline([], 0, 3, S) == "   "


def test_the_largest_numbers_there_are_do_no_harm() -> None:
    assert bars(-1.7e308, 1.7e308, width=2) == "▁█"
    assert len(plot([(0, -1.7e308), (S, 1.7e308)], S, 40, 5, S)) == 5


def test_a_plot_has_its_numbers_at_the_left_and_its_time_below() -> None:
    samples = [(i * S, float(i)) for i in range(11)]
    lines = plot(samples, 10 * S, 24, 6, 10 * S)
    assert lines[0].startswith("10 ┤")
    assert lines[2].startswith(" 5 ┤")
    assert lines[4].startswith(" 0 ┤")
    assert lines[5] == "   └-10 s            now"
    assert {len(line) for line in lines} == {24}


def test_a_rising_line_rises_from_the_lower_left_to_the_upper_right() -> None:
    samples = [(i * S, float(i)) for i in range(11)]
    curve = [line[4:] for line in plot(samples, 10 * S, 24, 6, 10 * S)[:5]]
    assert curve[0].strip() == curve[0][-4:].strip()
    starts = [len(line) - len(line.lstrip()) for line in curve]
    assert starts == sorted(starts, reverse=True)
    assert ord(curve[4][0]) & 0x40  # the dot at the lower left
    assert ord(curve[0][-1]) & 0x08  # and at the upper right
    assert "".join(curve).count(" ") < 5 * 20


def test_a_constant_runs_through_the_middle() -> None:
    lines = plot([(0, 3.0), (S, 3.0)], S, 13, 4, S)
    assert [bool(line[3:].strip()) for line in lines[:3]] == [False, True, False]


def test_only_what_is_in_the_time_shown_counts() -> None:
    samples = [(0, 1000.0), (9 * S, 1.0), (10 * S, 2.0)]
    assert plot(samples, 10 * S, 30, 4, 5 * S)[0].startswith("2 ┤")
    assert plot(samples[:1], 10 * S, 30, 4, 5 * S) == ["no number in the last 5 s"]
    assert plot([(10 * S, math.nan)], 10 * S, 30, 4, 5 * S) == ["no number in the last 5 s"]


@pytest.mark.parametrize(("width", "height"), [(1, 1), (5, 2), (9, 3), (300, 80)])
def test_any_size_will_do(width: int, height: int) -> None:
    assert plot([(0, 1.0), (S, -2.5)], S, width, height, S)


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "1"), (0.000012345, "1.2345e-05"), (123456.0, "1.2346e+05"), (7, "7"), (True, "true")],
)
def test_numbers_are_short(value: float, text: str) -> None:
    assert number_text(value) == text
