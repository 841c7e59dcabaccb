#!/usr/bin/env bash
# The Husky lab, line by line: a robot driven by the effort of its wheels, inspected from a shell.
#
# Prints each command as one would type it and what came back, and ends with what it checked.
# Exit code 0 when all of it holds. It runs on a bus of its own (a domain), so that it disturbs
# nobody; LCMTOOLS_DOMAIN=N chooses which.
. "$(dirname "${BASH_SOURCE[0]}")/../common.sh"

drives_at() { comes /husky0/odometry "abs(twist.twist.linear.x - $1) <= $2"; }
turns_at() { comes /husky0/odometry "abs(twist.twist.angular.z - $1) <= $2"; }

chapter 'The simulator, and what is on the bus'
simulate /morse lcmtools run sim --world husky
show lcmtools list
check 'list shows the odometry' shown /husky0/odometry
show lcmtools info /husky0/odometry
check 'info names the type of /husky0/odometry' shown nav_msgs/Odometry
check 'info names its publisher' shown ' * /morse'
show lcmtools echo -n 1 /husky0/odometry
check 'the Husky is at rest' drives_at 0 0.001
show lcmtools info /husky0/wheel_velocity_cmd
check 'wheel_velocity_cmd takes JointState' shown sensor_msgs/JointState
show lcmtools msg show sensor_msgs/JointState
check 'JointState has an effort' shown 'float64[] effort'

chapter 'Full power on both sides'
begin pub lcmtools pub /husky0/wheel_cmd sensor_msgs/JointState "name: ['left', 'right']
effort: [1, 1]"
check 'effort [1, 1] drives at 1.000 m/s (2 %)' drives_at 1.0 0.02
show lcmtools echo -n 1 /husky0/wheel_velocities
check 'the wheels turn at 6.06 rad/s (2 %)' comes /husky0/wheel_velocities 'abs(velocity[0] - 6.06) < 0.12'
end pub
check 'it goes on when pub is stopped' drives_at 1.0 0.02
show lcmtools pub -1 /husky0/wheel_cmd sensor_msgs/JointState "{name: [left, right], effort: [0, 0]}"
check 'effort [0, 0] stops' drives_at 0 0.01

chapter 'A controller that is not connected'
begin controller lcmtools run simple_controller
within 30 has_node /simple_controller
show lcmtools wtf
check 'wtf warns (exit code 1)' test "$code" -eq 1
check 'wtf names /odometry and /desired_velocity of /simple_controller' \
    eval 'shown " * /simple_controller:" && shown "   * /odometry" && shown "   * /desired_velocity"'
show lcmtools node list
show lcmtools node info simple_controller
check 'node info shows the topics of the controller' shown /controlled_velocity
show lcmtools node info morse
check 'node info shows the topics of the simulator' shown /husky0/velocity_cmd
end controller

chapter 'A namespace connects its input'
begin controller lcmtools run simple_controller __ns:=/husky0
within 30 has_node /husky0/simple_controller
show lcmtools node info /husky0/simple_controller
show lcmtools wtf
check 'odometry is connected, velocity_cmd is not' \
    eval '! shown "   * /husky0/odometry" && shown "   * /husky0/velocity_cmd"'
end controller

chapter 'A remap connects its output'
begin controller lcmtools run simple_controller __ns:=/husky0 controlled_velocity:=velocity_cmd
within 30 has_node /husky0/simple_controller
show lcmtools node info /husky0/simple_controller
check 'node info shows the new name' shown /husky0/velocity_cmd
show lcmtools wtf
check 'velocity_cmd is connected too' eval '! shown "   * /husky0/velocity_cmd"'
begin pub lcmtools pub /husky0/desired_velocity geometry_msgs/Twist \
    "{ linear: [0.1, 0, 0], angular: [0.0, 0, 0.1] }"
begin evaluate lcmtools run evaluate_controller __ns:=/husky0
within 30 has_node /husky0/evaluate_controller
check 'the controller reaches 0.1 m/s (5 %)' drives_at 0.1 0.005
check 'the controller reaches 0.1 rad/s (10 %)' turns_at 0.1 0.01
show lcmtools msg show air_lab0/ControllerEvaluationStat
check 'the message of one'\''s own is known' shown 'float64 average_error'
show lcmtools echo -n 2 /husky0/evaluation_stat
check 'the last error is below 0.02' comes /husky0/evaluation_stat 'last_error <= 0.02'
show lcmtools wtf
check 'wtf finds no errors or warnings (exit code 0)' test "$code" -eq 0
for name in evaluate pub controller; do end "$name"; done

chapter 'The same from a launch file'
begin launch lcmtools launch air_lab0 simple_controller.launch __ns:=/husky0
within 30 has_node /husky0/husky_simple_controller
check 'launch starts /husky0/husky_simple_controller' has_node /husky0/husky_simple_controller
keyboard steering lcmtools run steering /husky0/desired_velocity
keys up up up
check 'steering drives the controller at 0.3 m/s (5 %)' drives_at 0.3 0.015
keys space
no_more_keys steering
check 'and stops it at the end' drives_at 0 0.01
end launch
check 'Ctrl-C ends the launch and its nodes' eval '! has_node /husky0/husky_simple_controller'

chapter 'A package of one'\''s own'
show lcmtools pkg create air_lab0 --deps nav_msgs geometry_msgs --node my_controller
check 'pkg create makes a package' test -f air_lab0/pyproject.toml
begin controller lcmtools run air_lab0 my_controller __ns:=/husky0
within 30 has_node /husky0/my_controller
check 'run finds its node without installing' has_node /husky0/my_controller
end controller

chapter 'The end'
end sim
check 'the simulator leaves the bus: no node is left' no_nodes
finish
