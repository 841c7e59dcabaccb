"""Packages of ROS, and those of their nodes that lcmtools has, too."""

from collections.abc import Mapping

PACKAGES = {
    *("demo_nodes_cpp", "demo_nodes_py", "gazebo_ros", "image_tools", "image_view", "morse"),
    *("roscpp_tutorials", "rospy_tutorials", "rqt_robot_steering", "teleop_twist_keyboard"),
    *("tf", "tf2_ros", "tf2_tools", "turtlesim"),
}
"""Packages that are installed with ROS: a command or launch file may name them here."""
SAME_NODE: Mapping[str, str] = {
    "gazebo": "sim",
    "gzserver": "sim",
    "morse": "sim",
    "pioneer_teleop": "pioneer_manual_controller",
    "teleop_twist_keyboard": "teleop",
}
"""Other names of lcmtools' nodes, in the labs' texts and in ROS."""
