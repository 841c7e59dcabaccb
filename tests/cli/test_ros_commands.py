"""Commands of ROS and catkin, typed behind lcmtools, do what is meant and say how it is typed."""

import re
import subprocess

import pytest

from lcmtools.cli.bag.play import command as play
from lcmtools.cli.bag.record import command as record
from lcmtools.cli.completion.line import locate
from lcmtools.cli.completion.tree import describe
from lcmtools.cli.node.list import cleanup
from lcmtools.cli.param import get
from lcmtools.cli.ros import instead
from lcmtools.cli.topic.pub import command as pub
from lcmtools.errors import UsageError
from lcmtools.ros_words.commands import COMMANDS, OPTIONS


@pytest.mark.parametrize(
    "value", ["data: 'a\nb'", "a\tb\\n", "it's \x1b[2J\u0085 ü 你\n", "plain", "two words"]
)
def test_the_translated_command_can_be_pasted_into_a_shell(value, capsys):
    instead("", ["rostopic", "pub", "/chatter", "std_msgs/String", value])
    (line,) = capsys.readouterr().err.splitlines()
    typed = line.partition("lcmtools ")[2]
    shell = ["bash", "-c", f"printf '%s|' {typed}"]
    found = subprocess.run(
        shell, capture_output=True, text=True, check=True, env={"LC_ALL": "C.UTF-8"}
    )
    assert found.stdout == f"topic|pub|/chatter|std_msgs/String|{value}|"


def test_a_dependency_without_messages_is_left_out_and_named(capsys):
    words = ["catkin_create_pkg", "air_lab0", "rospy", "tf2_ros", "nav_msgs"]
    assert instead("", words) == ["pkg", "create", "air_lab0", "--deps", "nav_msgs"]
    assert "no messages in tf2_ros, which is left out" in capsys.readouterr().err


def test_other_words_are_no_commands_of_ros():
    assert instead("", ["lisst"]) == []
    assert instead("topic", ["rosfoo"]) == []
    with pytest.raises(UsageError):
        instead("param", ["delete", "/a/b"])


def test_what_is_meant_is_done(cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = cli("catkin_create_pkg", "air_lab0", "roscpp", "rospy", "nav_msgs")
    assert made.code == 0
    assert made.err.startswith("catkin_create_pkg is here: lcmtools pkg create air_lab0")
    built = cli("catkin", "build")
    assert (built.code, built.err.splitlines()[-1]) == (0, "ready: air_lab0")
    assert cli("rosmsg", "show", "std_msgs/String").out == "string data\n"
    deleted = cli("rosparam", "delete", "/a/b")
    assert deleted.code == 2
    assert deleted.err.splitlines()[-1].startswith(
        "lcmtools param: no such command 'delete'; a node"
    )


def test_a_node_whose_package_has_its_name_is_run(cli):
    said = cli("run", "image_view", "image_view", "--foo").err
    assert said.startswith("lcmtools run image_view: unknown argument '--foo'")


@pytest.mark.parametrize(
    ("command", "typed", "read"),
    [
        (play, "a -u 5 -l --wait-for-subscribers",
         {"duration": 5, "loops": True, "waits": True}),
        (record, "-O a --split 1GB --max-splits 3",
         {"output": "a", "split": "1GB", "max_files": 3}),
    ],
)  # fmt: skip
def test_options_of_rosbag_have_its_meaning(command, typed, read):
    assert read.items() <= command.make_context("", typed.split()).params.items()


@pytest.mark.parametrize("option", ["-y", "--yes", "-s", "--substitute-keywords", "--hide-type"])
def test_an_option_without_effect_is_accepted_and_not_shown(option):
    command, typed, path = {
        "y": (cleanup, "", "node cleanup"),
        "s": (pub, "/chatter std_msgs/String", "topic pub"),
        "h": (get, "talker rate", "param get"),
    }[option.strip("-")[0]]
    plain = command.make_context("", typed.split())
    assert command.make_context("", [*typed.split(), option]).params == plain.params
    assert option not in command.get_help(plain).split()
    place = locate(path.split(), "-", describe)
    assert place
    assert option in {name for one in place.command.options for name in one.names}
    assert option not in {name for one in place.unused_options() for name in one.names}


HINTS = [*COMMANDS.values(), *OPTIONS.values()]


@pytest.mark.parametrize("words", sorted({hint for hint in HINTS if isinstance(hint, tuple)}))
def test_the_words_in_place_of_a_command_of_ros_are_a_command(words):
    assert describe(words[:1]) is not None


@pytest.mark.parametrize("hint", sorted({hint for hint in HINTS if isinstance(hint, str)}))
def test_a_hint_names_commands_that_exist(hint):
    for words in re.findall(
        r"lcmtools ((?!finds)[a-z][a-z-]*(?: (?!opens)[a-z][a-z0-9-]*)?)", hint
    ):
        group, *verb = words.split()
        command = describe([group])
        assert command is not None, words
        assert not command.commands or set(verb) <= command.commands.keys(), words
