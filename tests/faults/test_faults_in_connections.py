"""Faults in who is connected to whom."""

from typing import Any

import pytest

UNFED, UNHEARD = "unconnected-subscriptions", "unconnected-publications"


def test_a_listener_outside_its_namespace(world: Any) -> None:
    world.node("talker", "__ns:=/robot")
    world.node("listener")
    found = world.finds(UNFED, "/listener", "/chatter", "start /listener with __ns:=/robot")
    world.obey(found)
    world.is_silent()


def test_a_node_whose_topic_plain_programs_have_in_a_namespace(world: Any) -> None:
    world.sends("bus.publish('/robot/chatter', String().encode())")
    world.node("listener")
    world.obey(world.finds(UNFED, "start /listener with __ns:=/robot"))
    world.is_silent()


def test_a_controller_without_its_namespace_and_remap(world: Any) -> None:
    """The Husky lab's own: two flags are missing, one after the other."""
    world.node("sim", "--world", "husky")
    world.node("simple_controller")
    world.tool("pub", "-r", "10", "/husky0/desired_velocity", "geometry_msgs/Twist", "{}")
    found = world.finds(
        UNFED, "/simple_controller", "/odometry", "/desired_velocity", "/husky0/velocity_cmd"
    )
    assert found.remedies[0].endswith("start /simple_controller with __ns:=/husky0")
    world.obey(found)
    found = world.finds(UNFED, "/husky0/velocity_cmd", "controlled_velocity:=velocity_cmd")
    world.obey(found)
    world.is_silent()


def test_a_remap_in_the_wrong_direction(world: Any) -> None:
    world.node("sim", "--world", "husky")
    world.node("simple_controller", "__ns:=/husky0", "velocity_cmd:=controlled_velocity")
    world.tool("pub", "-r", "10", "/husky0/desired_velocity", "geometry_msgs/Twist", "{}")
    found = world.finds(UNFED, "/husky0/velocity_cmd")
    assert found.remedies[0].endswith(
        "start /husky0/simple_controller with controlled_velocity:=velocity_cmd"
        " in place of velocity_cmd:=controlled_velocity"
    )
    world.obey(found)
    world.is_silent()


@pytest.mark.parametrize("name", ["chattr", "Chatter"])
def test_a_talker_whose_remap_has_a_slip(world: Any, name: str) -> None:
    world.node("talker", f"chatter:=/{name}")
    world.node("listener")
    found = world.finds(UNFED, "/listener", f"/{name}", "/talker")
    assert found.remedies[0].startswith("/talker publishes")
    world.obey(found)
    world.is_silent()


def test_a_listener_whose_remap_has_a_slip(world: Any) -> None:
    world.node("talker")
    world.node("listener", "chatter:=/chattter")
    world.obey(world.finds(UNFED, "start /listener without chatter:=/chattter"))
    world.is_silent()


def test_a_slip_in_what_is_sent_to_a_simulator(world: Any) -> None:
    world.node("sim", "--world", "dolly")
    world.node("moving_robot", "/dolly/cmd_vel:=/dolly/cmd_vle")
    found = world.finds(UNFED, "/gazebo", "/dolly/cmd_vel", "start /moving_robot without")
    world.obey(found)
    world.is_silent()


def test_a_plain_program_with_a_slip_in_its_channel(world: Any) -> None:
    world.sends("bus.publish('/chatterr', String().encode())")
    world.node("listener")
    world.obey(world.finds(UNFED, "start /listener with chatter:=/chatterr"))
    world.is_silent()


@pytest.mark.parametrize("channel", ["chatter", "/chatter "])
def test_a_plain_program_whose_channel_no_node_can_have(world: Any, channel: str) -> None:
    talker = world.sends(f"bus.publish('{channel}', String().encode())")
    world.node("listener")
    world.finds(
        UNFED, "/listener", f"'{channel}' is published", talker.pid, "publish on '/chatter'"
    )
    world.end(talker)
    world.sends("bus.publish('/chatter', String().encode())")
    world.is_silent()


def test_another_type_in_another_namespace(world: Any) -> None:
    talker = world.tool("pub", "-r", "10", "/robot/chatter", "std_msgs/Int32", "1", "__name:=a")
    world.node("listener")
    found = world.finds(UNFED, "/listener", "/a publishes /robot/chatter, but as std_msgs/Int32")
    assert "std_msgs/String" in found.remedies[0]
    world.end(talker)
    world.node("talker")
    world.is_silent()


def test_a_listener_that_nobody_speaks_to(world: Any) -> None:
    world.node("listener")
    assert world.finds(UNFED, "/listener", "/chatter").remedies == []
    world.node("talker")
    world.is_silent()


def test_a_talker_that_nobody_hears(world: Any) -> None:
    world.node("talker")
    world.finds(UNHEARD, "/talker", "/chatter")
    world.node("listener")
    world.is_silent()


def test_a_second_talker_with_a_slip(world: Any) -> None:
    world.node("talker")
    world.node("listener")
    world.node("talker", "__name:=other", "chatter:=/chatterr")
    world.finds(
        UNHEARD, "/other", "/listener hears /chatter: start /other without chatter:=/chatterr"
    )


def test_of_many_robots_each_namespace_is_offered(world: Any) -> None:
    world.node("talker", "__ns:=/husky0", "__name:=a")
    world.node("talker", "__ns:=/husky1", "__name:=b")
    world.node("listener", "__ns:=/husky1", "__name:=c")
    world.node("listener")
    found = world.finds(UNFED, "__ns:=/husky0 (or __ns:=/husky1)")
    world.obey(found)
    world.is_silent()
