"""A log in a browser: any moment by the time line, and the message of that moment."""

import re
from pathlib import Path

import pytest
from fixtures.wire import encode_event

from lcmtools.messages.codec import encode
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.packet import Packet
from tests.gui.conftest import panel_address, press_rare

S = 1_000_000_000
START = 1_795_000_000 * S
SLIDER = ".timeline-track"


@pytest.fixture
def log(page, serve, tmp_path):
    """A page of a log of a hundred seconds, in which /count has the seconds; it stands still."""
    packets = []
    for second in range(101):
        message = Float64()
        message.data = float(second)
        packets.append(Packet("/count", encode(message), START + second * S))
    path = tmp_path / "a.log"
    path.write_bytes(b"".join(encode_event(n, one) for n, one in enumerate(packets)))
    _, address = serve("topics", "--bag", str(path))
    page.goto(panel_address(address, "topics", topic="/count"))
    page.click("[aria-label='Pause (Space)']")
    page.wait_for_selector("[aria-label='Play (Space)']")
    return page


def _shows(page, value):
    page.wait_for_function(
        "value => document.querySelector('.tree').textContent.includes(value)", arg=value
    )


def test_a_moment_shows_the_message_before_it(log):
    box = log.locator(SLIDER).bounding_box()
    log.mouse.click(box["x"] + 1 + (box["width"] - 2) * 0.425, box["y"] + 10)
    _shows(log, "42.0")
    log.mouse.click(box["x"] + 1 + (box["width"] - 2) * 0.075, box["y"] + 10)  # and back
    _shows(log, "7.0")


def test_keys_step_and_seek(log):
    log.focus(SLIDER)
    log.keyboard.press("Home")
    _shows(log, "0.0")
    log.keyboard.press("ArrowRight")
    _shows(log, "5.0")
    log.keyboard.press(".")
    _shows(log, "6.0")
    log.keyboard.press("End")
    _shows(log, "100.0")
    assert log.locator(".timeline-clock").inner_text().endswith("/ 1:40.0")
    log.keyboard.press("Home")
    log.keyboard.press(">")
    log.keyboard.press(" ")
    log.wait_for_selector("[aria-label='Pause (Space)']")
    _shows(log, "3.0")
    assert log.input_value(".timeline select") == "2"


def test_a_plot_has_the_whole_log_and_the_value_where_it_is_played(log):
    address = log.url.partition("#")[0]
    log.goto("about:blank")
    log.goto(panel_address(address, "plot", fields=["/count/data"]))
    log.get_by_text("101 samples").wait_for()
    log.focus(SLIDER)
    log.keyboard.press("Home")
    log.keyboard.press("ArrowRight")
    row = log.locator(".plot-table tbody tr")
    row.locator("td", has_text=re.compile(r"^5$")).wait_for()
    log.locator(".plot-table th", has_text="at 5.00").wait_for()
    with log.expect_download() as download:
        press_rare(log, "Save as CSV")
    assert len(Path(download.value.path()).read_text().splitlines()) == 102
