"""The samples of curves in the page: gaps, times that go back, and bounded memory."""

import pytest


@pytest.fixture
def curves(serve, page):
    """``curves("...")``: what JavaScript returns that has ``Curves`` and ``add(times, values)``."""
    page.goto(serve("plot")[1])

    def run(body):
        return page.evaluate(
            """async () => {
              const { Curves } = await import("/panels/plot/curves.js");
              const curves = new Curves();
              const add = (times, value, curve = 0, kept = 600) => {
                const samples = times.flatMap((time) => [time, value(time), curve]);
                curves.add(new Float64Array(samples), (one) => one, kept);
              };
              const steady = (from, count, step = 0.1) =>
                Array.from({ length: count }, (_, index) => from + index * step);
            """
            f"{body}}}"
        )

    return run


def test_a_line_ends_where_a_topic_is_silent(curves):
    gaps = curves(
        "add(steady(100, 20), () => 1); add(steady(102, 30), () => 2, 1);"
        "add(steady(105, 10), () => 1); return curves.last.map((one) => one.gaps.slice(1));"
    )
    assert gaps == [[[pytest.approx(1.9), pytest.approx(5.0)]], []]


def test_a_line_ends_where_a_value_is_no_number(curves):
    column, gaps = curves(
        "add(steady(0, 5, 1), (time) => (time === 2 ? NaN : time));"
        "return [curves.columns[0], curves.last[0].gaps.slice(1)];"
    )
    assert column == [0, 1, None, 3, 4]
    assert gaps == [[1, 3]]


def test_times_that_go_back_begin_anew(curves):
    times, start = curves(
        "add(steady(500, 5, 1), () => 1); add([100, 101], () => 2);"
        "return [curves.times, curves.start];"
    )
    assert (times, start) == ([0, 1], 100)


def test_only_the_last_seconds_are_kept(curves):
    first, count, columns = curves(
        "for (let at = 0; at < 100; at++) add(steady(at * 100, 1000), () => 1, at % 2, 60);"
        "return [curves.times[0], curves.times.length, curves.columns.map((one) => one.length)];"
    )
    assert first > 9900 - 60
    assert count < 3000
    assert columns == [count, count]


def test_csv_has_a_row_for_each_time_and_nothing_where_a_curve_has_no_sample(curves):
    csv = curves(
        "add([1, 3], (time) => (time === 3 ? NaN : time)); add([3, 4], (time) => time, 1);"
        "return curves.csv(0, 10, [{curve: 0, label: '/a/x'}, {curve: 1, label: '/b,c'}]);"
    )
    assert csv.splitlines() == [
        'time,/a/x,"/b,c"',
        *("1.000000,1,", "3.000000,nan,3", "4.000000,,4"),
    ]
