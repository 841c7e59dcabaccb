"""The simulator's world in a page: robots move as they say, and the page moves them. Metres."""

import io
import json
import math
import re
import time
from contextlib import closing

import pytest
from PIL import Image

from lcmtools.bus.open import open_bus
from lcmtools.bus.url import parse_url
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft
from lcmtools.observe.reading.received import messages
from lcmtools.types.geometry_msgs import PoseStamped, TransformStamped
from lcmtools.types.nav_msgs import OccupancyGrid, Odometry
from lcmtools.types.sensor_msgs import PointCloud2, PointField
from lcmtools.types.tf2_msgs import TFMessage
from lcmtools.types.visualization_msgs import Marker
from tests.gui.conftest import panel_address, press_rare

_LONG = 40.0  # [s] for what comes
_COLOURED = 80  # red less green, of 255
_MOST = 900  # messages, thirty seconds of them
WORLD = """\
node: yard
objects:
  - {type: box, name: crate, size: [0.5, 0.5, 0.5], pose: [1.5, -1, 0], mass: 5}
  - {type: walls, points: [[-5, -5], [5, -5], [5, 5]], height: 1}
robots:
  - {model: husky, namespace: /husky0, pose: [0, 0, 0]}
"""


@pytest.fixture(params=["bullet", "mujoco"])
def world(request, start, lcmtools_path, bus_url, tmp_path):
    """The address of the window of a simulator with a Husky and a crate."""
    pytest.importorskip({"bullet": "pybullet", "mujoco": "mujoco"}[request.param])
    file = tmp_path / "yard.yaml"
    file.write_text(WORLD)
    words = ("--engine", request.param, "--lcm-url", bus_url)
    start(lcmtools_path, "run", "sim", str(file), *words).wait_for("simulating")
    server = start(lcmtools_path, "gui", "world", "--port", "0", "--no-open", "--lcm-url", bus_url)
    return server.wait_for("http://").split()[-1]


def wait_for(page, script, value=None):
    """Wait until a function of the page is true."""
    page.wait_for_function(script, arg=value, timeout=1000 * _LONG)


def pose(page, name):
    """The place and heading of a body as the page's list has them."""
    page.locator(f"[data-pose^='{name} ']").wait_for(state="attached", timeout=1000 * _LONG)
    text = page.locator(f"[data-pose^='{name} ']").get_attribute("data-pose")
    x, y, yaw = map(float, text.split()[1:])
    return x, y, yaw


HAS_LEFT = """([x, y, far]) => {
  const found = document.querySelector("[data-pose^='/husky0 ']").dataset.pose.split(" ");
  return Math.hypot(found[1] - x, found[2] - y) > far;
}"""
IS_AT = """([name, x, y, near]) => {
  const found = document.querySelector(`[data-pose^='${name} ']`)?.dataset.pose.split(" ") ?? [];
  return Math.hypot(found[1] - x, found[2] - y) < near;
}"""


def is_at(page, name, x, y, near=0.1):
    wait_for(page, IS_AT, [name, x, y, near])


def drag(page, start, end):
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    page.mouse.move(*end)
    page.mouse.up()


def is_where_its_wheels_say(page, url):
    """Wait until the odometry is shown as it is: wheels slip at a wall. The robot does a step."""
    with closing(messages("/husky0/odometry", url=url, wall_time=True, timeout=_LONG)) as arrivals:
        press_rare(page, "Step")
        odometry = next(arrivals).message
    assert isinstance(odometry, Odometry)
    place = odometry.pose.pose.position
    is_at(page, "/husky0/odometry", place.x, place.y, 0.06)


def test_a_robot_moves_as_the_simulator_says_and_is_paused_and_dragged(
    world, page, bus_url, start, lcmtools_path, cli
):
    page.goto(world)
    is_at(page, "/husky0", 0, 0)
    is_at(page, "crate", 1.5, -1)
    twist = "{linear: {x: 0.5}}"
    words = ("pub", "-r", "10", "/husky0/cmd_vel", "geometry_msgs/Twist", twist)
    driver = start(lcmtools_path, *words, "--lcm-url", bus_url)
    wait_for(
        page,
        "() => document.querySelector(`[data-pose^='/husky0 ']`).dataset.pose.split(' ')[1] > 0.8",
    )
    driver.end()
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Resume").wait_for()
    press_rare(page, "Step")
    page.get_by_text("did 24 steps").wait_for()
    state = json.loads(cli("sim", "state", "husky0", "--json", "--lcm-url", bus_url).out)
    place = state["pose"]["position"]
    is_at(page, "/husky0", place["x"], place["y"], 0.02)
    is_at(page, "/husky0/ground_truth", place["x"], place["y"], 0.02)
    is_where_its_wheels_say(page, bus_url)
    press_rare(page, "Reset")
    is_at(page, "/husky0", 0, 0, 0.05)
    page.get_by_role("button", name="Resume").click()
    page.get_by_role("button", name="Pause").wait_for()
    page.get_by_role("button", name="Move").click()
    press_rare(page, "Top")
    page.get_by_role("button", name="/husky0", exact=True).click()
    box = page.locator(".world-stage canvas").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = pose(page, "/husky0")
    drag(page, middle, (middle[0], middle[1] - 0.2 * box["height"]))
    wait_for(page, HAS_LEFT, [*before[:2], 0.5])
    assert math.hypot(*pose(page, "/husky0")[:2]) < 10


def test_the_camera_follows_the_robot_also_on_a_page_that_is_opened_again(
    world, page, bus_url, start, lcmtools_path
):
    page.goto(world)
    is_at(page, "/husky0", 0, 0)
    assert page.get_by_label("Follow").input_value() == "/husky0"
    words = ("pub", "-r", "10", "/husky0/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.5}}")
    driver = start(lcmtools_path, *words, "--lcm-url", bus_url)
    wait_for(page, HAS_LEFT, [0, 0, 2])
    driver.end()
    for way in (-0.1, 0.1):  # of the height: there and back, not into a wall
        page.get_by_role("button", name="Move").click()
        before = pose(page, "/husky0")[:2]
        box = page.locator(".world-stage canvas").bounding_box()
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0], middle[1] + way * box["height"])
        wait_for(page, HAS_LEFT, [*before, 0.3])  # shown at once, before the simulator does it
        page.mouse.up()
        page.reload()
        page.locator("[data-pose^='/husky0 ']").wait_for(state="attached")


def test_odometry_leaves_a_trail(world, page, bus_url, start, lcmtools_path):
    shown = {"/husky0/ground_truth": False}
    color = {"/husky0/odometry": "#ff00ff"}
    page.goto(panel_address(world, "world", shown=shown, colors=color))
    is_at(page, "/husky0", 0, 0)
    words = ("pub", "-r", "10", "/husky0/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 0.5}}")
    driver = start(lcmtools_path, *words, "--lcm-url", bus_url)
    wait_for(page, HAS_LEFT, [0, 0, 2])
    driver.end()
    press_rare(page, "Top")
    page.wait_for_timeout(1000)  # some frames
    picture = Image.open(io.BytesIO(page.locator(".world-stage").screenshot())).convert("RGB")
    places = [
        (x, y)
        for x in range(0, picture.width, 2)
        for y in range(0, picture.height, 2)
        if (pixel := picture.getpixel((x, y)))[0] > 150 and pixel[2] > 150 and pixel[1] < 120
    ]
    spans = [max(values) - min(values) for values in zip(*places, strict=True)]
    assert max(spans) > 0.2 * picture.height  # without it, no more than the arrow is seen


def test_a_crate_is_dragged_and_the_robot_stays(world, page, bus_url):
    page.goto(world)
    is_at(page, "crate", 1.5, -1)
    page.get_by_role("button", name="Move").click()
    press_rare(page, "Top")
    page.get_by_role("button", name="crate", exact=True).click()
    box = page.locator(".world-stage canvas").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    drag(page, middle, (middle[0] + 0.2 * box["height"], middle[1]))
    with closing(messages("/yard/poses", url=bus_url, wall_time=True, timeout=_LONG)) as arrivals:
        for count, arrival in enumerate(arrivals):
            assert isinstance(arrival.message, TFMessage)
            frames = {one.child_frame_id: one.transform for one in arrival.message.transforms}
            place = frames["ground_truth/crate"].translation
            has_moved = math.hypot(place.x - 1.5, place.y + 1) > 0.3
            shown = pose(page, "crate")
            # It may be on its way: the page sends where the pointer was, too.
            if has_moved and math.hypot(place.x - shown[0], place.y - shown[1]) < 0.1:
                break
            assert count < _MOST, f"the crate is at {place.x}, {place.y}, shown at {shown}"
    is_at(page, "/husky0", 0, 0)


def test_a_click_sends_a_pose(world, page, bus_url):
    page.goto(world)
    is_at(page, "/husky0", 0, 0)
    page.get_by_role("button", name="Send pose").click()
    box = page.locator(".world-stage canvas").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + 0.6 * box["height"]
    with closing(messages("/goal", url=bus_url, wall_time=True, timeout=_LONG)) as arrivals:
        drag(page, middle, (middle[0] + 60, middle[1]))
        page.get_by_text(re.compile("^sent x ")).wait_for()
        drag(page, middle, (middle[0] + 60, middle[1]))  # it listens by now
        message = next(arrivals).message
    assert isinstance(message, PoseStamped)
    assert message.header.frame_id == "world"
    place, turn = message.pose.position, message.pose.orientation
    assert math.hypot(place.x, place.y) < 5
    assert math.hypot(turn.z, turn.w) == pytest.approx(1)


def test_without_webgl_the_list_still_has_the_poses(world, page):
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(world)
    page.get_by_text("This browser has no WebGL").wait_for()
    is_at(page, "/husky0", 0, 0)


def status(page, topic, text):
    """Wait until a topic's line in the list of displays says something."""
    line = page.locator(".world li", has=page.get_by_text(topic, exact=True))
    line.get_by_text(text).wait_for(timeout=1000 * _LONG)


def until(is_true):
    """Ask until it is true."""
    deadline = time.monotonic() + _LONG
    while not is_true():
        assert time.monotonic() < deadline


def frames_drawn(page):
    return int(page.locator(".world-stage canvas").get_attribute("data-frames") or 0)


def cloud(kind, size):
    """A cloud of two points with x, y and z of a type, and bytes of one point."""
    found = PointCloud2()
    found.header.frame_id, found.width, found.height, found.point_step = "world", 2, 1, size
    for index, name in enumerate("xyz"):
        field = PointField()
        field.name, field.offset, field.datatype, field.count = name, 8 * index, kind, 1
        found.fields.append(field)
    found.data, found.row_step = bytes(2 * size), 2 * size
    return found


def with_rgb(found, kind):
    """A cloud of x, y and z as float64, with colours of a type."""
    field = PointField()
    field.name, field.offset, field.datatype, field.count = "rgb", 24, kind, 1
    found.fields.append(field)
    return found


@pytest.fixture
def bus(bus_url):
    """A program that publishes."""
    opened = open_bus(parse_url(bus_url))
    yield opened
    opened.close()


def test_malformed_messages_are_told_and_the_other_displays_go_on(
    start, lcmtools_path, bus_url, bus, page
):
    server = start(lcmtools_path, "gui", "world", "--port", "0", "--no-open", "--lcm-url", bus_url)
    nameless, grid, large = TFMessage(), OccupancyGrid(), OccupancyGrid()
    nameless.transforms.append(TransformStamped())
    grid.info.width = grid.info.height = 1000
    large.header.frame_id, large.info.width, large.info.height = "world", 20_000, 1
    large.info.resolution, large.data = 0.01, [100] * 20_000
    goal = PoseStamped()
    goal.header.frame_id = "world"
    sent = {
        "/tf": nameless,
        "/goal": goal,
        "/grid": grid,
        "/large": large,
        "/short": cloud(PointField.FLOAT64, 8),
        "/doubles": cloud(PointField.FLOAT64, 24),
        "/narrow_rgb": with_rgb(cloud(PointField.FLOAT64, 26), PointField.UINT16),
        "/integers": cloud(PointField.INT32, 24),
    }
    page.goto(server.wait_for("http://").split()[-1])
    page.locator(".world").wait_for()
    for topic, message in sent.items():
        bus.publish(topic, encode(message))
    for topic in ("/doubles", "/integers", "/short", "/narrow_rgb"):
        page.locator(".world li", has=page.get_by_text(topic, exact=True)).locator(
            "input[type=checkbox]"
        ).check()
    status(page, "/tf", "it has an empty name")
    status(page, "/grid", "1000 x 1000 cells")
    status(page, "/short", "the field 'y' ends at byte 16 of a point, which has 8")
    status(page, "/integers", "not drawn: it has no x, y and z as float32 or float64")
    status(page, "/doubles", "points")
    status(page, "/narrow_rgb", "points")
    status(page, "/large", "map")
    status(page, "/goal", "pose")
    before = frames_drawn(page)
    goal.pose.position.x = 1.0
    bus.publish("/goal", encode(goal))
    wait_for(page, "n => document.querySelector('canvas').dataset.frames > n", before)


def test_a_frame_is_grey_once_its_publisher_is_gone_though_others_use_its_topic(
    start, lcmtools_path, bus_url, bus, page
):
    server = start(lcmtools_path, "gui", "world", "--port", "0", "--no-open", "--lcm-url", bus_url)
    camera = {"position": [0, -4, 2], "target": [0, 0, 0.5]}
    page.goto(panel_address(server.wait_for("http://").split()[-1], "world", camera=camera))
    box = {"header": {"frame_id": "gone"}, "type": 1, "scale": dict.fromkeys("xyz", 1)}
    bus.publish("/box", encode(draft(Marker, {**box, "color": {"r": 1, "a": 1}}).message))
    message = TFMessage()
    for name in ("here", "gone"):
        one = TransformStamped()
        one.header.frame_id, one.child_frame_id, one.transform.rotation.w = "world", name, 1.0
        message.transforms.append(one)

    def red():
        """How red the middle of the view is, while the transforms are sent."""
        bus.publish("/tf", encode(message))
        shot = page.locator(".world-stage canvas").screenshot()
        image = Image.open(io.BytesIO(shot)).convert("RGB")
        r, g, _ = image.getpixel((image.width // 2, image.height // 2))
        return float(r - g)

    page.locator(".world-displays li", has_text="/box").wait_for()
    for _ in range(2):  # what is sent once stays as it is
        until(lambda: red() > _COLOURED)
    message.transforms.pop()
    until(lambda: abs(red()) < _COLOURED / 4)
    status(page, "/tf", "old: 1 of 2 frames, 'gone' for")


def test_what_is_old_says_so_from_the_first_picture_on_and_nothing_is_drawn_while_nothing_moves(
    start, lcmtools_path, bus_url, page, browser
):
    simulator = start(lcmtools_path, "run", "sim", "husky", "--lcm-url", bus_url)
    simulator.wait_for("simulating")
    server = start(lcmtools_path, "gui", "world", "--port", "0", "--no-open", "--lcm-url", bus_url)
    address = server.wait_for("http://").split()[-1]
    page.goto(address)
    is_at(page, "/husky0", 0, 0)
    wait_for(
        page,
        """async () => {
          const { dataset } = document.querySelector(".world-stage canvas");
          const before = dataset.frames;
          await new Promise((done) => setTimeout(done, 1000));
          return before > 0 && dataset.frames === before;
        }""",
    )
    simulator.end()
    status(page, "/husky0/odometry", "old: the last message came")
    late = browser.new_page()
    late.goto(address)
    status(late, "/husky0/odometry", "old: the last message came")
    late.close()
