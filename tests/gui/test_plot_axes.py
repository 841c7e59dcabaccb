"""The axes of plots: times of messages, one curve over another, units, and chosen limits."""

import csv
import math

import pytest

from lcmtools import Node
from lcmtools.types.nav_msgs import Odometry
from lcmtools.types.rosgraph_msgs import Clock
from lcmtools.types.std_msgs import Float64
from tests.gui.conftest import open_more, panel_address, press_rare

X, Y = "/odom/pose.pose.position.x", "/odom/pose.pose.position.y"
COLORED = """() => {
  const canvas = document.querySelector(".plot-room canvas");
  const { width, height } = canvas;
  const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
  const columns = new Array(width).fill(0);
  for (let at = 0; at < data.length; at += 4) {
    const [red, green, blue, shade] = data.slice(at, at + 4);
    const color = Math.max(red, green, blue) - Math.min(red, green, blue);
    if (shade > 60 && color > 50) columns[(at / 4) % width] += 1;
  }
  return [Math.max(...columns), columns.reduce((one, other) => one + other), height];
}"""
"""The most coloured pixels in a column of the chart, all, and its height: of curves, not axes."""


class Robot:
    """A program that publishes odometry, numbers, and simulated time."""

    def __init__(self):
        self.node = Node("robot")
        self.odometry = self.node.create_publisher(Odometry, "/odom")
        self.number = self.node.create_publisher(Float64, "/number")
        self.clock = self.node.create_publisher(Clock, "/clock")

    def drive(self, x, y=0.0, stamp=0):
        """Publish a place [m] with a stamp [s]."""
        message = Odometry()
        message.pose.pose.position.x, message.pose.pose.position.y = x, y
        message.header.stamp.sec = stamp
        self.odometry.publish(message)

    def say(self, value):
        """Publish a number."""
        message = Float64()
        message.data = value
        self.number.publish(message)

    def tick(self, seconds):
        """Publish simulated time."""
        message = Clock()
        message.clock.sec = seconds
        self.clock.publish(message)


@pytest.fixture
def robot(module_start_node):
    """A robot on the module's bus."""
    robots = []

    def make():
        robots.append(Robot())
        return robots[0].node

    module_start_node(make)
    return robots[0]


@pytest.fixture
def plot(serve, page):
    """``plot("/a/data", x="stamp")``: a page with a plot."""

    def run(*fields, **settings):
        page.goto(panel_address(serve()[1], "plot", fields=list(fields), **settings))
        page.locator(".plot-table").wait_for()
        return page

    return run


def until_plotted(page, label, send, text):
    """Publish until the table has a value: the plot may follow the topic only then."""
    row = page.locator(".plot-table tbody tr", has_text=label)
    for _ in range(400):
        send()
        page.wait_for_timeout(50)
        if row.locator("td").first.inner_text() == text:
            return
    pytest.fail(f"the table has {row.locator('td').first.inner_text()}, not {text}")


def saved(page, folder):
    """The rows of the plot's CSV."""
    with page.expect_download() as download:
        press_rare(page, "Save as CSV")
    download.value.save_as(folder / "plot.csv")
    return list(csv.DictReader((folder / "plot.csv").read_text().splitlines()))


def test_the_first_sample_of_a_waiting_plot_is_drawn(plot, robot):
    page = plot("/number/data")
    page.get_by_text("no message of /number has come yet").wait_for()
    robot.say(3.25)
    page.locator(".plot-table td", has_text="3.25000").wait_for()
    page.wait_for_function(f"() => ({COLORED})()[1] >= 9")
    assert page.locator(".plot-table .muted").inner_text() == "1 sample"


def test_a_curve_is_plotted_over_another_one_with_units(plot, robot):
    page = plot(X, Y, window=0)
    until_plotted(page, X, lambda: robot.drive(1.0), "1")
    assert page.locator(".plot-table th button").all_inner_texts() == [f"{X} [m]", f"{Y} [m]"]
    for y in (1.0, 0.0, 2.0):
        robot.drive(2.0, y)
    open_more(page)
    page.get_by_label("Horizontal axis").select_option(f"over {X}")
    page.wait_for_function(
        f"() => {{ const [most, , high] = ({COLORED})(); return most > high / 3; }}"
    )
    page.get_by_role("button", name=f"Remove {X}").click()
    assert page.get_by_label("Horizontal axis").input_value() == "arrival"


def test_samples_are_at_their_stamps_in_their_order(plot, robot, tmp_path):
    page = plot(X, x="stamp", window=0)
    until_plotted(page, X, lambda: robot.drive(1.0, stamp=500), "1")
    for value, stamp in ((2.0, 501), (4.0, 503), (3.0, 502), (5.0, 504)):
        robot.drive(value, stamp=stamp)
        page.wait_for_timeout(100)
    page.locator(".plot-table td", has_text="5").first.wait_for()
    rows = saved(page, tmp_path)
    found = [(float(row["time"]), float(row[X])) for row in rows]
    assert found == [(500.0, 1.0), (501.0, 2.0), (502.0, 3.0), (503.0, 4.0), (504.0, 5.0)]


def test_messages_without_a_time_are_named(plot, robot):
    page = plot("/number/data", X, x="stamp")
    for _ in range(3):
        robot.say(1.0)
        robot.drive(1.0)
    notice = page.locator(".notice")
    notice.get_by_text("the messages of /number have no time: they have no header.stamp").wait_for()
    notice.get_by_text("the messages of /odom have no time: header.stamp is 0").wait_for()


def test_samples_are_at_simulated_time(plot, robot, tmp_path):
    page = plot("/number/data", x="simulated", window=0)

    def send():
        robot.tick(77)
        robot.say(1.5)

    until_plotted(page, "/number", send, "1.50000")
    assert {row["time"] for row in saved(page, tmp_path)} == {"77.000000"}


def test_values_that_are_not_finite_are_named(plot, robot, tmp_path):
    page = plot("/number/data", window=0)
    until_plotted(page, "/number", lambda: robot.say(math.inf), "inf")
    until_plotted(page, "/number", lambda: robot.say(-math.inf), "-inf")
    until_plotted(page, "/number", lambda: robot.say(math.nan), "nan")
    until_plotted(page, "/number", lambda: robot.say(1e300), "1.0000e+300")
    values = [row["/number/data"] for row in saved(page, tmp_path)]
    assert list(dict.fromkeys(values)) == ["inf", "-inf", "nan", "1e+300"]


def test_the_value_axis_is_chosen_and_kept(plot, robot):
    page = plot("/number/data")
    until_plotted(page, "/number", lambda: robot.say(1.5), "1.50000")
    open_more(page)
    for label, value in (("Lower end", "-2"), ("Upper end", "-4"), ("Least span", "3")):
        page.get_by_label(label).fill(value)
        page.get_by_label(label).press("Enter")
    page.get_by_text("the value axis cannot go from -2 to -4").wait_for()
    page.get_by_label("Upper end").fill("8")
    page.get_by_label("Upper end").press("Enter")
    page.get_by_text("the value axis cannot go").wait_for(state="hidden")
    page.wait_for_function("() => decodeURIComponent(location.hash).includes('\"most\":8')")
    page.reload()
    assert page.get_by_label("Upper end").input_value() == "8"


LIMITS = [
    ((0, 1), {"least": -2, "most": 5}, (-2, 5)),
    ((0, 1), {"least": 0}, (0, 1.08)),
    ((0, 1), {"most": 3}, (-0.08, 3)),
    ((0, 1), {"least": 7}, (7, 8)),
    ((0, 1), {"most": -7, "span": 3}, (-10, -7)),
    ((5, 5.001), {"span": 2}, (4.0005, 6.0005)),
    ((0, 10), {"span": 2}, (-0.8, 10.8)),
    ((-1.7e308, 1.7e308), {}, (-8.988465674311579e307, 8.988465674311579e307)),
    ((None, None), {"span": 8}, (-4, 4)),
]


def test_limits_are_chosen_or_fit_the_values_and_ticks_are_told_apart(plot):
    free = {"least": None, "most": None, "span": None}
    found, ticks = plot().evaluate(
        """async ([rows, spans]) => {
          const { axisLimits, valueSteps } = await import("/panels/plot/limits.js");
          const { tickText, timeTicks } = await import("/panels/plot/texts.js");
          const limits = rows.map(([[least, most], axis]) => axisLimits(least, most, axis));
          const ticks = (from, to, step) =>
            timeTicks(from, to, step, null).map((tick) => tickText(tick, step));
          return [limits, spans.map(([from, to]) => ticks(from, to, valueSteps(to - from).at(-2)))];
        }""",
        [
            [[values, free | chosen] for values, chosen, _ in LIMITS],
            [
                [low * span / 2, low * span / 2 + span / 2]
                for span in (1e-300, 1e-5, 1, 37, 1e6, 1e300, 1.7e308)
                for low in (0, -0.5, 1)
            ],
        ],
    )
    assert found == [pytest.approx(limits) for *_, limits in LIMITS]
    for texts in ticks:
        assert len(set(texts)) == len(texts) >= 1, texts
        assert all(math.isfinite(float(text)) for text in texts), texts
