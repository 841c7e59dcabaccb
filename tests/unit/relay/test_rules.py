"""The rules by which a relay passes topics on, and under which name."""

import pytest

from lcmtools.errors import UsageError
from lcmtools.relay.rules import Direction, Reason, Route, Rules, check_rules

TWIST, STRING = "geometry_msgs/Twist", "std_msgs/String"


def _there(rules, channel, *types, obeyed=False):
    return Direction(rules, back=False).route(channel, types, obeyed=obeyed)


def _back(rules, channel, *types):
    return Direction(rules, back=True).route(channel, types)


def test_everything_passes_but_commands_and_clocks():
    rules = Rules()
    assert _there(rules, "/odom", "nav_msgs/Odometry") == Route("/odom")
    assert _there(rules, "POSE") == Route("POSE")
    assert _there(rules, "/x", STRING, TWIST).reason is Reason.COMMAND
    assert _there(rules, "/wheel_cmd").reason is Reason.COMMAND
    assert (
        _there(rules, "/efforts_in", "sensor_msgs/JointState", obeyed=True).reason is Reason.COMMAND
    )
    assert _back(rules, "/cmd_vel", TWIST).reason is Reason.COMMAND
    assert _there(rules, "/clock").reason is Reason.NAMED_ONLY
    assert _there(rules, "LCM_SELF_TEST").reason is Reason.NAMED_ONLY


@pytest.mark.parametrize("allow", [["**"], ["/cmd_*"], ["/**", "POSE"]])
def test_a_pattern_lets_no_command_pass(allow):
    rules = Rules(allow)
    assert _there(rules, "/cmd_vel", TWIST).reason is Reason.COMMAND


def test_a_command_passes_by_its_very_name():
    for name in ("/cmd_vel", "cmd_vel"):
        rules = Rules(["**", name])
        assert _there(rules, "/cmd_vel", TWIST, obeyed=True) == Route("/cmd_vel")
        assert _there(rules, "/a/cmd_vel", TWIST).reason is Reason.COMMAND
    assert _there(Rules(["/clock"]), "/clock") == Route("/clock")


def test_allow_leaves_out_the_others_and_deny_has_precedence():
    rules = Rules(["/husky0/**", "MAP"], ["**/image"])
    assert _there(rules, "/husky0/odom") == Route("/husky0/odom")
    assert _there(rules, "/husky0/camera/image").reason is Reason.DENIED
    assert _there(rules, "/husky1/odom").reason is Reason.NOT_ALLOWED
    assert _there(rules, "MAP") == Route("MAP")
    named_too = Rules(["/cmd_vel"], ["/cmd_*"])
    assert _there(named_too, "/cmd_vel").reason is Reason.DENIED


def test_a_services_channels_are_matched_by_its_name():
    rules = Rules(["/reset"])
    for ending in ("_request", "_reply"):
        assert _there(rules, f"/reset/{ending}") == Route(f"/reset/{ending}")
    assert _there(Rules(deny=["/reset"]), "/reset/_request").reason is Reason.DENIED
    assert _there(Rules(["/talker/**"]), "/talker/_parameters/_request").reason is None


def test_a_prefix_is_put_on_there_and_taken_off_on_the_way_back():
    rules = Rules(["/odom", "POSE", "/cmd_vel"], prefix="robot7")
    assert _there(rules, "/odom") == Route("/robot7/odom")
    assert _there(rules, "POSE") == Route("robot7/POSE")
    assert _back(rules, "/robot7/cmd_vel", TWIST) == Route("/cmd_vel")
    assert _back(rules, "robot7/POSE") == Route("POSE")
    for channel in ("/odom", "/robot70/odom", "/robot7/", "/robot7", "POSE"):
        assert _back(rules, channel).reason is Reason.ELSEWHERE
    assert _there(Rules(prefix="robot7"), "/" + "a" * 60).reason is Reason.TOO_LONG


def test_rates_and_newest_are_by_pattern_of_here():
    rules = Rules(rates={"/camera/**": 5.0, "/camera/info": 2.0}, newest=["/camera/*"], prefix="r")
    assert _there(rules, "/camera/image") == Route("/r/camera/image", None, 0.2, newest=True)
    assert _there(rules, "/camera/info").period == 0.5
    assert _back(rules, "/r/camera/image") == Route("/camera/image", None, 0.2, newest=True)


def test_one_way_lets_nothing_back():
    rules = Rules(one_way=True)
    assert _there(rules, "/odom") == Route("/odom")
    assert _back(rules, "/odom").reason is Reason.ONE_WAY


@pytest.mark.parametrize("prefix", ["a b", "7", "a//b", "_a", "é"])
def test_a_prefix_is_a_namespace(prefix):
    with pytest.raises(UsageError):
        check_rules(Rules(prefix=prefix))
    check_rules(Rules(prefix="lab/robot7"))
