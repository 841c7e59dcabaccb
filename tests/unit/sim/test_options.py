"""The simulator's command line."""

import math
import re

import pytest

from lcmtools.errors import UsageError
from lcmtools_sim.__main__ import main
from lcmtools_sim.completion import complete
from lcmtools_sim.engines import ENGINES
from lcmtools_sim.main import overridden
from lcmtools_sim.options import parse_options
from lcmtools_sim.world_file import read_scene
from lcmtools_sim.worlds import find_world


def test_without_arguments_it_is_the_husky_world_in_real_time():
    options = parse_options([])
    assert (options.world, options.rate, options.seed) == ("husky", 1.0, None)


@pytest.mark.parametrize("arguments", [["empty"], ["--world", "empty"], ["--world=empty", "empty"]])
def test_a_world_is_given_as_a_word_or_as_an_option(arguments):
    assert parse_options(arguments).world == "empty"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--rate", "fast"], "argument --rate: must be times real time, 0 or more, not 'fast'"),
        (["--rate", "-1"], "argument --rate: must be times real time, 0 or more, not '-1'"),
        (["--rate", "nan"], "argument --rate: must be times real time, 0 or more, not 'nan'"),
        (["--rate", "inf"], "argument --rate: must be times real time, 0 or more, not 'inf'"),
        (["--seed", "1.5"], "argument --seed: must be a whole number, 0 or more, not '1.5'"),
        (["--duration", "0"], "argument --duration: must be a number of seconds above 0, not '0'"),
        (["--wrold", "x"], "unrecognized arguments: --wrold"),
        (["--world"], "argument --world: expected one argument"),
        (["a", "--world", "b"], "two worlds are given, 'a' and 'b'"),
    ],
)
def test_a_mistake_is_one_clear_line(arguments, reason):
    with pytest.raises(UsageError) as caught:
        parse_options(arguments)
    assert caught.value.what.startswith(reason)


def test_worlds_are_listed_with_what_they_are(capsys):
    assert main(["--list-worlds"]) == 0
    assert capsys.readouterr().out == (
        "dolly    An open place with things to see by laser and one Dolly: the world of the lab"
        " on nodes\n"
        "empty    The ground and nothing on it\n"
        "husky    A walled yard with one Husky: the world of the TDDE05 lab\n"
        "multi    Several Huskies in the open: /husky0, /husky1, ... as many as --robots says\n"
        "pioneer  A walled room with tables and one Pioneer with a Kinect: the world of the depth"
        " camera lab\n"
    )


def test_completion_offers_every_option_and_the_engines(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    shown = re.findall(r"^  (?:-h, )?(--[a-z-]+)", capsys.readouterr().out, re.MULTILINE)
    assert sorted(complete([], "-")) == sorted(shown)
    assert list(complete(["--engine"], "")) == list(ENGINES)
    assert list(complete([], "--engine=b")) == [f"--engine={name}" for name in ENGINES]
    assert "husky" in complete(["--engine", "mujoco"], "")
    assert not complete(["--engine", "mujoco", "husky"], "")
    assert not complete(["--world", "husky"], "")


def test_a_printed_world_can_be_checked(capsys, tmp_path_factory):
    assert main(["--print-world", "husky"]) == 0
    file = tmp_path_factory.mktemp("worlds") / "mine.yaml"
    file.write_text(capsys.readouterr().out)
    assert main(["--check", str(file)]) == 0
    assert capsys.readouterr().out == f"{file}: ok, husky /husky0; 11 objects\n"


def test_a_bad_world_is_one_line_and_exit_code_2(capsys, tmp_path_factory):
    file = tmp_path_factory.mktemp("worlds") / "bad.yaml"
    file.write_text("node: a\nrobots: 3\n")
    assert main(["--world", str(file)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == (
        f"lcmtools run sim: {file}:2: 'robots' must be a list, not a single value\n"
    )


def test_help_shows_examples(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--help"])
    assert caught.value.code == 0
    assert "lcmtools run sim --world ./yard.yaml --rate 4" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--robot", "huski"], "argument --robot: unknown model 'huski'; did you mean husky?"),
        (["--robot", "husky@1,2"], "argument --robot: must be MODEL or MODEL@X,Y,YAW, for example"),
        (["--robot", "husky@1,2,nan"], "argument --robot: must be MODEL or MODEL@X,Y,YAW"),
        (["--robot", "husky@1,2,ldeg"], "argument --robot: must be MODEL or MODEL@X,Y,YAW"),
        (["--only", "a,,b"], "argument --only: must be names with commas between, not 'a,,b'"),
    ],
)
def test_a_mistake_with_robots_is_one_clear_line(arguments, reason):
    with pytest.raises(UsageError) as caught:
        parse_options(arguments)
    assert caught.value.what.startswith(reason)


def test_robots_are_added_where_they_are_asked_for():
    options = parse_options(["--robot", "husky@1,-2,90deg", "--robot", "dolly"])
    assert [(model.name, pose.x, pose.y) for model, pose in options.added] == [
        ("husky", 1.0, -2.0),
        ("dolly", 0.0, 0.0),
    ]
    assert options.added[0][1].yaw == pytest.approx(math.pi / 2)


def asked(*arguments):
    options = parse_options(arguments)
    return overridden(read_scene(*find_world(options.world)), options)


def names(scene):
    return [robot.namespace for robot in scene.robots]


def test_added_robots_get_the_next_free_names():
    scene, _ = asked("husky", "--robot", "husky@3,0,0", "--robot", "husky@6,0,0")
    assert names(scene) == ["/husky0", "/husky1", "/husky2"]
    assert scene.robots[2].pose.x == 6.0


def test_the_process_with_the_first_robot_leads_and_others_follow():
    leading, leader = asked("multi", "--robots", "6", "--only", "husky1,/husky0")
    following, follower = asked("multi", "--robots", "6", "--only", "husky4,husky3")
    assert (names(leading), leader.follow, leading.node) == (["/husky0", "/husky1"], False, "sim")
    assert (names(following), follower.follow) == (["/husky3", "/husky4"], True)
    assert following.node == "sim_husky3"
    assert following.objects == leading.objects


def test_a_process_with_follow_is_a_node_of_another_name():
    scene, options = asked("pioneer", "--follow")
    assert (scene.node, options.follow) == ("gazebo_pioneer", True)


def test_a_robot_that_is_not_there_cannot_be_the_only_one():
    with pytest.raises(UsageError) as caught:
        asked("multi", "--only", "husky9")
    assert str(caught.value).startswith("the world multi has no robot '/husky9'; did you mean")


def test_what_a_world_of_gazebo_holds_and_is_left_out_is_said(capsys, tmp_path):
    file = tmp_path / "park.world"
    file.write_text("<sdf><world name='w'><light name='a'/><light name='b'/></world></sdf>")
    assert main(["--check", str(file)]) == 1
    captured = capsys.readouterr()
    assert captured.out == f"{file}: read in part, no robot; 0 objects\n"
    assert captured.err == f"lcmtools run sim: {file}: left out: light (2)\n"
