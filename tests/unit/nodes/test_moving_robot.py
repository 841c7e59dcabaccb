"""The node that drives the Dolly."""

from lcmtools.labs.nodes.moving_robot import MovingRobot
from lcmtools.types.geometry_msgs import Twist


def test_moving_robot_commands_its_circle_every_half_second(bench):
    bench.start(MovingRobot, "_use_sim_time:=true")
    bench.advance_time(0.25, 0.5, 0.75, 1.0, 1.25)
    commands = bench.published("/dolly/cmd_vel", Twist)
    assert [(twist.linear.x, twist.angular.z) for twist in commands] == [(0.5, 0.3)] * 2
    rest = [
        twist.linear.y + twist.linear.z + twist.angular.x + twist.angular.y for twist in commands
    ]
    assert rest == [0.0, 0.0]


def test_moving_robot_logs_what_it_publishes(bench, capsys):
    bench.start(MovingRobot, "_use_sim_time:=true")
    bench.advance_time(0.5)
    text = "Publishing: linear.x 0.50 m/s, angular.z 0.30 rad/s"
    assert capsys.readouterr().err == f"[INFO] [0.500000000] [/moving_robot]: {text}\n"
