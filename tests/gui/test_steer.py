"""The page drives the simulator's Husky, which stops whatever happens to the page."""

import itertools
import os
import shlex
import signal
from contextlib import closing, suppress
from pathlib import Path

import pytest

from lcmtools.observe.reading.received import messages
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from tests.gui.conftest import panel_address

TOPIC = "/husky0/cmd_vel"
_LONG = 40.0  # [s] for what comes
_MOST = 900  # speeds, thirty seconds of them
_FAST, _SLOW = 0.2, 0.01  # [m/s]
_STEADY = 7  # commands


@pytest.fixture(scope="module", autouse=True)
def _husky(module_start, lcmtools_path):
    module_start(lcmtools_path, "run", "sim", "husky").wait_for("simulating")


@pytest.fixture
def commands(module_bus_url):
    """``commands()``: the next message on the topic that is steered."""
    with closing(messages(TOPIC, url=module_bus_url, wall_time=True, timeout=_LONG)) as arrivals:

        def take():
            message = next(arrivals).message
            assert isinstance(message, Twist)
            return message

        yield take


def speeds(url):
    """The Husky's speed by its odometry, as it comes [m/s]."""
    for arrival in messages("/husky0/odometry", url=url, wall_time=True, timeout=_LONG):
        assert isinstance(arrival.message, Odometry)
        yield arrival.message.twist.twist.linear.x


def wait_for_speed(url, is_right):
    with closing(speeds(url)) as found:
        seen = []
        for speed in found:
            if is_right(speed):
                return
            seen.append(speed)
            assert len(seen) < _MOST, f"the last speeds are {seen[-5:]}"


def moves(url):
    """Wait until the Husky moves."""
    wait_for_speed(url, lambda speed: speed > _FAST)


def stands(url):
    """Wait until the Husky stands."""
    wait_for_speed(url, lambda speed: abs(speed) < _SLOW)


def reading(page):
    """The forward speed that the page shows."""
    return str(page.locator(".reading output").first.inner_text())


def hold_joystick(page):
    """Push the joystick forward, and hold it."""
    page.get_by_text("obeyed by").wait_for()
    box = page.locator(".pad").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0], box["y"] + box["height"] * 0.25)
    page.locator(".steer.is-held").wait_for()


def test_the_joystick_drives_until_it_is_let_go(serve, page, module_bus_url, commands):
    page.goto(serve("steer", TOPIC)[1])
    hold_joystick(page)
    moves(module_bus_url)
    speeds_sent = (commands().linear.x for _ in itertools.count())
    in_a_row = 0  # a page that a busy computer holds up for 0.35 s is stopped, and drives again
    while in_a_row < _STEADY:
        speed = next(speeds_sent)
        assert not speed or speed == pytest.approx(0.5, abs=0.01)
        in_a_row = in_a_row + 1 if speed else 0
    page.mouse.up()
    stands(module_bus_url)
    assert {round(one, 2) for one in itertools.takewhile(bool, speeds_sent)} <= {0.5}
    assert [next(speeds_sent) for _ in range(2)] == [0, 0]  # the stop is sent three times
    page.get_by_text("Not driving").wait_for()


def test_keys_drive_while_they_are_held(serve, page, module_bus_url):
    page.goto(serve("steer", TOPIC, "--max-linear", "0.6")[1])
    page.get_by_text("obeyed by").wait_for()
    page.locator(".pad").focus()
    page.keyboard.down("w")
    moves(module_bus_url)
    assert reading(page) == "+0.30"
    page.keyboard.press("Escape")
    stands(module_bus_url)
    page.keyboard.up("w")


def test_keys_drive_at_once_where_steering_is_all_there_is(serve, page, module_bus_url):
    page.goto(serve("steer", TOPIC)[1])
    page.get_by_text("obeyed by").wait_for()
    page.keyboard.down("w")
    moves(module_bus_url)
    page.keyboard.up("w")
    stands(module_bus_url)
    page.locator(".steer-status").click()  # takes the focus from the joystick
    page.keyboard.down("s")
    wait_for_speed(module_bus_url, lambda speed: speed < -_FAST)
    page.keyboard.up("s")
    stands(module_bus_url)


def test_nobody_drives_faster_than_the_command_line_says(serve, page, commands):
    address = serve("steer", TOPIC, "--max-linear", "0.4")[1]
    page.goto(panel_address(address, "steer", topic=TOPIC, linear=1000))
    page.get_by_text("obeyed by").wait_for()
    field = page.get_by_label("Largest forward speed")
    assert field.input_value() == "0.4"
    field.fill("1000")
    page.keyboard.press("Enter")
    assert field.input_value() == "0.4"
    page.locator(".pad").focus()
    page.keyboard.down("Shift")
    page.keyboard.down("w")
    assert commands().linear.x == pytest.approx(0.4)
    page.keyboard.up("w")
    page.keyboard.up("Shift")


def test_what_is_still_held_after_a_stop_drives_no_more(serve, page, module_bus_url):
    page.goto(serve("steer", TOPIC)[1])
    hold_joystick(page)
    moves(module_bus_url)
    page.keyboard.press(" ")
    page.mouse.move(400, 300, steps=5)
    assert reading(page) == "0.00"
    stands(module_bus_url)
    page.mouse.up()
    hold_joystick(page)
    moves(module_bus_url)


def test_a_finger_on_the_joystick_drives(serve, page, browser, module_bus_url):
    page.goto(serve("steer", TOPIC)[1])
    page.get_by_text("obeyed by").wait_for()
    box = page.locator(".pad").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    session = browser.new_cdp_session(page)

    def touch(kind, *points):
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": list(points)})

    touch("touchStart", {"x": x, "y": y})
    touch("touchMove", {"x": x, "y": box["y"] + box["height"] * 0.2})
    moves(module_bus_url)
    touch("touchEnd")
    stands(module_bus_url)


def test_a_gamepad_drives_once_it_has_been_at_rest(serve, page, module_bus_url):
    page.add_init_script(
        "window.axes = [0, 0, 0, 0]; window.buttons = [{ pressed: false }]; navigator.getGamepads ="
        " () => [{ id: 'pad', connected: true, axes: window.axes, buttons: window.buttons }];"
    )
    page.goto(serve("steer", TOPIC)[1])
    page.get_by_text("obeyed by").wait_for()
    page.get_by_label("Gamepad").check()
    page.evaluate("window.axes = [0, -0.5, 0, 0]")
    page.wait_for_timeout(200)  # some readings of the stick
    assert reading(page) == "0.00"
    page.evaluate("window.buttons = [{ pressed: true }]")
    moves(module_bus_url)
    page.evaluate("window.buttons = [{ pressed: false }]")
    stands(module_bus_url)
    page.evaluate("window.buttons = [{ pressed: true }]")
    moves(module_bus_url)
    page.keyboard.press("Escape")  # the stick is still pushed
    stands(module_bus_url)
    page.wait_for_timeout(200)  # some readings of the stick
    assert reading(page) == "0.00"
    page.evaluate("window.axes = [0.01, 0.02, 0, 0]")
    page.wait_for_timeout(200)
    page.evaluate("window.axes = [0, -1, 0, 0]")
    moves(module_bus_url)
    assert reading(page) == "+1.00"


def test_it_stops_when_the_page_hangs(serve, page, module_bus_url):
    page.goto(serve("steer", TOPIC)[1])
    hold_joystick(page)
    moves(module_bus_url)
    page.evaluate("setTimeout(() => { const end = Date.now() + 4000; while (Date.now() < end); })")
    stands(module_bus_url)


def test_it_stops_when_the_page_is_hidden(serve, page, module_bus_url):
    page.goto(serve("steer", TOPIC)[1])
    hold_joystick(page)
    moves(module_bus_url)
    page.evaluate(
        "Object.defineProperty(document, 'hidden', { get: () => true });"
        "document.dispatchEvent(new Event('visibilitychange'))"
    )
    stands(module_bus_url)
    assert reading(page) == "0.00"


def test_it_stops_when_the_browser_is_killed(serve, launch_browser, tmp_path, module_bus_url):
    folder = tmp_path / "killed"
    context = launch_browser(folder)
    page = context.new_page()
    page.goto(serve("steer", TOPIC)[1])
    hold_joystick(page)
    moves(module_bus_url)
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if str(folder).encode() in (process / "cmdline").read_bytes():
                os.kill(int(process.name), signal.SIGKILL)
    stands(module_bus_url)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_stops_when_the_server_ends(serve, page, module_bus_url, number):
    server, address = serve("steer", TOPIC)
    page.goto(address)
    hold_joystick(page)
    moves(module_bus_url)
    server.send_signal(number)
    stands(module_bus_url)
    page.get_by_text("The server is gone").wait_for()


def test_ctrl_z_stops_the_robot_before_it_suspends_the_server(
    module_start, lcmtools_path, page, module_bus_url, commands
):
    command = (
        f"{shlex.quote(lcmtools_path)} gui steer {TOPIC} --port 0 --no-open & echo pid $!; wait"
    )
    shell = module_start(
        "bash", "-c", f"set -m; {command}"
    )  # a job of a shell, which alone can be suspended
    server = int(shell.wait_for("pid").split()[-1])
    try:
        page.goto(shell.wait_for("http://").split()[-1])
        hold_joystick(page)
        sent = (round(commands().linear.x, 2) for _ in itertools.count())
        assert next(filter(None, sent)) == 0.5
        os.kill(server, signal.SIGTSTP)
        assert {*itertools.takewhile(bool, sent)} <= {0.5}
        assert [next(sent), next(sent)] == [0, 0]
        stands(module_bus_url)
    finally:
        os.kill(server, signal.SIGKILL)


@pytest.mark.parametrize("number", [signal.SIGSTOP, signal.SIGKILL])
def test_it_stops_when_the_server_is_suspended_or_killed(
    serve, page, module_bus_url, commands, number
):
    server, address = serve("steer", TOPIC)
    page.goto(address)
    hold_joystick(page)
    moves(module_bus_url)
    sent = (round(commands().linear.x, 2) for _ in itertools.count())
    assert next(filter(None, sent)) == 0.5
    server.send_signal(number)
    assert {*itertools.takewhile(bool, sent)} <= {0.5}
    stands(module_bus_url)
    page.mouse.up()
    if number == signal.SIGKILL:
        page.get_by_text("The server is gone").wait_for()
        return
    server.send_signal(signal.SIGCONT)
    page.keyboard.down("s")
    assert next(filter(None, sent)) == -0.5  # what has waited is thrown away
    page.keyboard.up("s")
    stands(module_bus_url)


def test_the_stop_button_stops_what_another_program_drives(
    serve, page, module_bus_url, module_start, lcmtools_path
):
    page.goto(serve("steer", TOPIC)[1])
    page.get_by_text("obeyed by").wait_for()
    joystick = page.locator(".pad").bounding_box()
    once = module_start(
        *(lcmtools_path, "pub", "-1", TOPIC, "geometry_msgs/Twist", "{linear: {x: 0.4}}")
    )
    assert once.wait() == 0
    moves(module_bus_url)
    page.get_by_text(f"commands {TOPIC} too").wait_for()
    assert page.locator(".pad").bounding_box() == joystick  # no notice moves it under a finger
    page.get_by_role("button", name="Stop").click()
    stands(module_bus_url)


def test_a_page_that_is_refused_does_not_say_that_it_drives(serve, page, browser, module_bus_url):
    address = serve("steer", TOPIC)[1]
    page.goto(address)
    other = browser.new_page()
    other.goto(address)
    hold_joystick(page)
    moves(module_bus_url)
    other.get_by_text("obeyed by").wait_for()
    other.keyboard.down("s")
    other.locator(".notice", has_text="another page is driving").wait_for()
    other.get_by_text("Not driving").wait_for()
    assert float(reading(other)) == 0
    other.close()
    page.mouse.up()
    stands(module_bus_url)


def test_who_may_only_watch_is_told_so(serve, page):
    page.goto(serve("steer", TOPIC, "--read-only")[1])
    page.get_by_text("This page may only watch, not command").wait_for()
    assert page.get_by_role("button", name="Stop").is_disabled()


def test_topics_without_velocities_are_not_steered(serve, page):
    page.goto(serve("steer", "/husky0/wheel_cmd")[1])
    page.get_by_text("sensor_msgs/JointState commands no velocity").wait_for()
    page.get_by_label("Topic of velocity commands").fill(TOPIC)
    page.keyboard.press("Enter")
    page.get_by_text("obeyed by /morse").wait_for()
