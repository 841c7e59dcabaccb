"""Numbers and names as the page writes, reads and collects them; without messages."""

import json
import math
from pathlib import Path

import pytest

_TEXTURE = 8192  # [px] that every WebGL 2 has, but for small devices
TABLE = json.loads((Path(__file__).parents[1] / "fixtures" / "texts.json").read_text())


@pytest.fixture
def run(serve, page):
    """``run("...", data)``: what a JavaScript function returns in the page."""
    page.goto(serve("topics")[1])
    return page.evaluate


@pytest.mark.parametrize("kind", TABLE)
def test_numbers_have_the_same_texts_as_in_python(kind, run):
    found = run(
        """async ([kind, rows]) => {
          const texts = await import("/texts.js");
          return rows.map(([value]) => [value, texts[`${kind}Text`](value)]);
        }""",
        [kind, TABLE[kind]],
    )
    assert found == TABLE[kind]


def test_a_time_in_a_file_name_is_that_of_the_page_s_clock(run, page):
    zone = {"timezoneId": "Asia/Kolkata"}
    page.context.new_cdp_session(page).send("Emulation.setTimezoneOverride", zone)
    found = run(
        """async (time) => {
          const { clockText, fileTimeText } = await import("/texts.js");
          return [fileTimeText(time), clockText(time)];
        }""",
        86_399.25,
    )
    assert found == ["1970-01-02_05-29-59-250", "05:29:59.250"]


def test_numbers_that_json_lacks_are_read_and_texts_are_kept(run):
    found = run(
        """async (data) => {
          const { hasPlace, withNumbers } = await import("/panels/world/numbers.js");
          const { frame, longest, pose } = withNumbers(data);
          const shown = pose.map(String);
          return [frame, String(longest), shown, hasPlace({ pose }), hasPlace({ longest })];
        }""",
        {"kind": "scan", "frame": "nan", "longest": "inf", "pose": ["nan", 1, "-inf", None]},
    )
    assert found == ["nan", "Infinity", ["NaN", "1", "-Infinity", "null"], False, True]


def test_a_trail_keeps_the_newest_steps_and_begins_anew_where_a_robot_was_put(run):
    found = run(
        """async (count) => {
          const { Trail } = await import("/panels/world/trail.js");
          const trail = new Trail("world", "#ff0000");
          for (let index = 0; index <= count; index += 1) trail.add([0.1 * index, 0, 0]);
          const length = trail.mesh.geometry.drawRange.count;
          const places = Array.from({ length }, (_, index) => trail.position.getX(index));
          const steps = trail.count;
          trail.add([0, 5, 0]);
          return [steps, length, Math.min(...places), Math.max(...places), trail.count];
        }""",
        4500,
    )
    assert found == [2500, 15000, pytest.approx(200), pytest.approx(450), 0]


def test_a_long_text_in_the_world_is_no_wider_than_a_texture(run):
    widths = run(
        """async (texts) => {
          const { label } = await import("/panels/world/shapes.js");
          const look = { pose: [0, 0, 0, 0, 0, 0, 1], scale: [0, 0, 1], color: [1, 1, 1, 1] };
          return texts.map((text) => label({ ...look, text }).material.map.image.width);
        }""",
        ["", "W", "W" * 20_000, "\N{ROBOT FACE}" * 20_000],
    )
    assert 0 < widths[0] < widths[1] < max(widths) <= _TEXTURE


def test_the_first_view_is_from_behind_a_robot_wherever_it_heads(run):
    (x, y), turned = run(
        """async (yaws) => {
          const { View } = await import("/panels/world/view.js");
          return yaws.map((yaw) => {
            let place = [];
            const view = { lookAt: (from) => (place = from) };
            View.prototype.lookFromBehind.call(view, [10, 7, 0], yaw);
            return [place[0] - 10, place[1] - 7];
          });
        }""",
        [0, math.pi / 2],
    )
    assert x < -1
    assert turned == pytest.approx([-y, x])


def test_a_robot_in_the_root_namespace_is_called_the_robot(run):
    script = """async (names) => {
      const { bodyText } = await import("/panels/world/bodies.js");
      return names.map(bodyText);
    }"""
    assert run(script, ["/", "/husky0", "crate"]) == ["the robot", "/husky0", "crate"]


def test_a_path_that_a_simulator_paints_and_publishes_is_drawn_once(run):
    shown = run(
        """async (markers) => {
          const { default: World } = await import("/panels/world.js");
          let shown;
          const display = { receive: (data) => void (shown = data.markers), leaveTrail() {} };
          const topics = [["/path", "path"], ["/odometry", "odometry"]].map(
            ([topic, kind]) => ({ topic, kind }));
          const world = Object.assign(Object.create(World.prototype), { topics, bodies: {} });
          world.receive(display, { kind: "markers", markers });
          return shown;
        }""",
        [{"ns": "/path"}, {"ns": "/odometry"}, {"ns": "wall"}],
    )
    assert shown == [{"ns": "/odometry"}, {"ns": "wall"}]
