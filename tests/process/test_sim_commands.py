"""``lcmtools sim``: what it says to a simulator, and what the simulator then does."""

import json

import pytest
from fixtures.says import assert_line, assert_says

pytest.importorskip("pybullet")


WORLD = """\
node: yard
robots:
  - {model: husky, namespace: /husky0}
  - {model: dolly, namespace: /dolly, pose: [0, 4, 0]}
"""


@pytest.fixture(scope="module")
def _simulator(module_start, tmp_path_factory, lcmtools_path):
    """A paused simulator on the module's bus."""
    world = tmp_path_factory.mktemp("world") / "yard.yaml"
    world.write_text(WORLD)
    module_start(lcmtools_path, "run", "sim", str(world), "--paused").wait_for("simulating")


@pytest.fixture(autouse=True)
def _anew(
    use_module_bus,  # noqa: ARG001 - before anything is asked
    _simulator,
    cli,
    monkeypatch,
):
    """Every test begins with the same paused world, at time 0."""
    monkeypatch.setenv("LCMTOOLS_COLOR", "never")
    for verb in ("pause", "reset"):
        result = cli("sim", verb)
        assert result.code == 0, result.err


@pytest.fixture
def tell(cli):
    """Runs ``lcmtools sim ...``, which must work, and gives what it prints."""

    def run(*arguments):
        result = cli("sim", *arguments)
        assert (result.code, result.err) == (0, ""), arguments
        return result.out

    return run


def state(tell, robot):
    answer = json.loads(tell("state", robot, "--json"))
    assert isinstance(answer, dict)
    return answer


def test_a_paused_simulator_does_the_requested_steps_and_no_more(tell):
    assert tell("step") == "did 1 step, now at 0.004167 s\n"
    assert tell("step", "239") == "did 239 steps, now at 1.000000 s\n"
    assert state(tell, "husky0")["time"] == 1_000_000_000
    assert state(tell, "husky0")["time"] == 1_000_000_000


def test_pause_and_resume_say_what_was(tell, wait_until):
    assert tell("pause") == "was already paused\n"
    assert tell("resume") == "resumed\n"
    wait_until(lambda: state(tell, "husky0")["time"] > 100_000_000)
    assert tell("resume") == "was not paused\n"
    assert tell("pause") == "paused\n"
    assert state(tell, "husky0")["time"] == state(tell, "husky0")["time"]


def test_a_robot_is_where_it_is_put(tell):
    assert tell("set-pose", "husky0", "-3.5", "-2", "90deg") == "/husky0 was placed there\n"

    answer = state(tell, "/husky0")

    assert answer["model"] == "husky"
    position, turned = answer["pose"]["position"], answer["pose"]["orientation"]
    assert (position["x"], position["y"]) == pytest.approx((-3.5, -2.0), abs=1e-4)
    assert (turned["z"], turned["w"]) == pytest.approx((0.5**0.5, 0.5**0.5), abs=1e-4)


def test_state_is_text_for_people_too(tell):
    text = tell("state", "dolly")

    assert 'model: "dolly"' in text
    assert "y: 4.0" in text


def test_a_robot_comes_with_its_topics_and_goes_with_them(tell, cli, wait_until):
    assert_line(tell("spawn", "pioneer", "p3dx", "-4", "-1"), "pioneer", "/p3dx", "added")
    wait_until(lambda: "/p3dx/RosAria/pose" in cli("list").out)
    tell("step", "24")
    assert state(tell, "p3dx")["pose"]["position"]["x"] == pytest.approx(-4, abs=1e-3)

    assert tell("delete", "p3dx") == "/p3dx was removed\n"
    wait_until(lambda: "/p3dx/" not in cli("list").out)
    assert cli("sim", "state", "p3dx").code == 1


def test_reset_takes_away_what_has_come_and_brings_back_what_has_gone(tell):
    tell("delete", "dolly")
    tell("spawn", "husky", "husky7", "6", "6")
    tell("step", "10")

    answer = json.loads(tell("reset", "--json"))

    assert answer["success"] is True
    assert_says(answer["message"], "everything", "start")
    assert state(tell, "dolly")["time"] == 0
    assert state(tell, "dolly")["pose"]["position"]["y"] == pytest.approx(4.0)


def test_a_rate_is_kept_until_another_one_is_set(tell):
    assert_line(tell("set-rate", "0"), "simulated time", "as fast as possible")
    assert_line(tell("set-rate", "0.5"), "simulated time", "0.5 times real time")
    assert_line(tell("set-rate", "1"), "simulated time", "1 times real time")


def test_at_a_very_slow_rate_it_still_answers_and_speeds_up_again(tell, wait_until):
    tell("set-rate", "0.0001")
    tell("resume")
    first = state(tell, "husky0")["time"]
    tell("set-rate", "1")

    wait_until(lambda: state(tell, "husky0")["time"] > first + 100_000_000)


def test_a_snapshot_is_a_png_file_and_none_is_overwritten(cli, tmp_path):
    file = tmp_path / "yard.png"
    result = cli("sim", "snapshot", str(file), "--width", "64", "--height", "48")
    assert (result.code, result.out) == (0, "")
    assert result.err == f"wrote {file}: {file.stat().st_size} bytes\n"
    head = file.read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    assert [int.from_bytes(head[i : i + 4], "big") for i in (16, 20)] == [64, 48]

    assert cli("sim", "snapshot", str(file)).code == 2
    assert cli("sim", "snapshot", str(file), "--force", "--robot", "dolly").code == 0
    assert file.read_bytes()[:24] != head


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["state", "husky1"], "there is no robot 'husky1'; did you mean /husky0?"),
        (["spawn", "huski", "a", "9", "9"], "unknown model 'huski'; did you mean husky?"),
        (
            ["snapshot", "x.png", "--robot", "r2d2"],
            "there is no robot 'r2d2'; known: /husky0, /dolly",
        ),
    ],
)
def test_failures_are_one_line_and_exit_code_1(cli, arguments, complaint):
    result = cli("sim", *arguments)

    assert (result.code, result.out) == (1, "")
    assert result.err == f"lcmtools sim {arguments[0]}: /yard: {complaint}\n"


def test_a_running_simulator_is_not_stepped(tell, cli):
    tell("resume")
    result = cli("sim", "step")

    assert result.code == 1
    assert_line(result.err, "lcmtools sim step: /yard: ", "not paused; ", "pause")


def test_another_node_is_no_simulator(start, cli, lcmtools_path):
    start(lcmtools_path, "run", "talker").wait_for("hello")

    result = cli("sim", "pause", "--sim", "talker")

    assert result.code == 1
    parts = ("/talker", "not a simulator; ", "/yard\n")
    assert_line(result.err, "lcmtools sim pause: ", *parts)


@pytest.mark.parametrize(("command", "timeout"), [("echo", "1.5"), ("hz", "2.5")])
def test_a_paused_simulator_is_the_reason_why_nothing_comes(command, timeout, cli):
    result = cli(command, "/husky0/imu", "--timeout", timeout)
    assert result.code == 4
    assert "the simulator /yard is paused: lcmtools sim resume" in result.err
