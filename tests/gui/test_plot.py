"""Plots show the values of the messages, every one of them."""

import csv
import json
import math
import re
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from lcmtools import Node
from lcmtools.types.std_msgs import Float64
from tests.gui.conftest import panel_address, press_rare

_FIELD = "/wave/data"
_LIMITS = json.loads((Path(__file__).parents[1] / "fixtures" / "value_limits.json").read_text())
Publish = Callable[[float], None]


@pytest.fixture
def publish(module_start_node):
    """``publish(1.5)`` publishes a number on /wave."""
    node = module_start_node(lambda: Node("source")).node
    publisher = node.create_publisher(Float64, "/wave")

    def send(value):
        message = Float64()
        message.data = value
        publisher.publish(message)

    return send


def _latest(page, label):
    """The latest value of a curve, as the table has it; NaN for none."""
    row = page.locator(".plot-table tbody tr", has_text=label)
    text = row.locator("td").first.inner_text()
    return math.nan if text == "\N{EN DASH}" else float(text)


def _plotted(page, publish, value, label=_FIELD):
    """Publish a number, again and again, until it is the latest in the table."""
    deadline = time.monotonic() + 40
    while _latest(page, label) != value:
        assert time.monotonic() < deadline, f"the table has {_latest(page, label)}"
        publish(value)
        page.wait_for_timeout(50)


def test_every_sample_is_plotted_and_saved(serve, page, publish, tmp_path):
    page.goto(serve("plot", _FIELD)[1])
    page.get_by_text("no message of /wave has come yet").wait_for()
    _plotted(page, publish, 0.5)
    for count in range(200):
        publish(math.nan if count == 100 else count / 8)
    page.locator(".plot-table td", has_text="24.8750").first.wait_for()
    with page.expect_download() as download:
        press_rare(page, "Save as CSV")
    download.value.save_as(tmp_path / "wave.csv")
    rows = list(csv.DictReader((tmp_path / "wave.csv").read_text().splitlines()))
    values = [float(row[_FIELD]) for row in rows]
    last = values[-200:]
    assert [one for one in last if not math.isnan(one)] == [n / 8 for n in range(200) if n != 100]
    assert math.isnan(last[100])
    times = [float(row["time"]) for row in rows]
    assert times == sorted(times)
    assert abs(times[-1] - time.time()) < 40
    assert page.locator(".plot-table .muted").inner_text() == f"{len(rows)} samples"


def test_a_field_is_added_by_typing_and_by_the_tree_and_kept(serve, page, publish):
    _, address = serve()
    page.goto(panel_address(address, "plot"))
    publish(1.0)
    page.get_by_role("button", name="Fields").click()
    page.locator("summary", has_text="/wave").click()
    page.get_by_label("data float64").check()
    _plotted(page, publish, 1.5)
    page.get_by_role("button", name=f"Remove {_FIELD}").click()
    assert page.locator(".plot-table tbody tr").count() == 0
    field = page.get_by_label("Add a field")
    field.fill("/wave/")
    page.locator(f"datalist option[value='{_FIELD}']").wait_for(state="attached")
    field.fill(_FIELD)
    field.press("Enter")
    _plotted(page, publish, 2.5)
    page.wait_for_url(re.compile("wave"))
    page.reload()
    _plotted(page, publish, 3.5)


def test_a_wrong_field_is_explained_and_the_others_are_plotted(serve, page, publish):
    page.goto(serve("plot", _FIELD, "/wave/date", "/weve/data")[1])
    publish(1.0)
    _plotted(page, publish, 4.5)
    notice = page.locator(".notice").first
    page.get_by_text("no field 'date'").wait_for()
    assert "no field 'date' (fields: data); did you mean data?" in notice.inner_text()
    assert "did you mean /wave/data?" in notice.inner_text()


def test_what_is_shown_is_paused_moved_and_followed_by_keys(serve, page, publish):
    page.goto(serve("plot", _FIELD)[1])
    publish(1.0)
    _plotted(page, publish, 5.5)
    pause = page.get_by_role("button", name="Pause (space)")
    page.locator(".plot-room").focus()
    page.keyboard.press(" ")
    assert pause.get_attribute("aria-pressed") == "true"
    _plotted(page, publish, 6.5)  # samples are taken all the same
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("+")
    assert pause.get_attribute("aria-pressed") == "true"
    page.keyboard.press("Home")
    assert pause.get_attribute("aria-pressed") == "false"


def test_the_value_axis_has_the_same_limits_as_in_python(serve, page):
    page.goto(serve("plot", _FIELD)[1])
    found = page.evaluate(
        """async (rows) => {
          const { valueLimits } = await import("/panels/plot/limits.js");
          return rows.map(([least, most]) => valueLimits(least, most));
        }""",
        _LIMITS,
    )
    assert found == [pytest.approx(row[2:], rel=1e-7) for row in _LIMITS]
