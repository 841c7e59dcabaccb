"""The command of ROS 1 that does what a command of lcmtools does."""

from collections.abc import Mapping


def _verbs(tool: str, verbs: str, group: str = "") -> dict[str, str]:
    """Return the equivalents of verbs that ROS has with the same name."""
    return {f"{group} {verb}".strip(): f"{tool} {verb}" for verb in verbs.split()}


EQUIVALENTS: Mapping[str, str] = {
    **_verbs("rostopic", "list info echo pub hz bw delay type find"),
    **_verbs("rosnode", "list info ping kill machine cleanup", "node"),
    **_verbs("rosmsg", "list show package packages", "msg"),
    **_verbs("rossrv", "list show", "srv"),
    **_verbs("rosservice", "list info call type find args", "service"),
    **_verbs("rosparam", "list get set dump load", "param"),
    **_verbs("rosbag", "record play info filter fix reindex", "bag"),
    "bag export": "rosbags-convert",
    "bag import": "rosbags-convert",
    "bag plot": "rqt_bag",
    "foxglove": "foxglove_bridge",
    "graph": "rqt_graph",
    "gui all": "rqt",
    "gui graph": "rqt_graph",
    "gui image": "rqt_image_view",
    "gui log": "rqt_console",
    "gui parameters": "rqt_reconfigure",
    "gui plot": "rqt_plot",
    "gui record": "rqt_bag",
    "gui services": "rqt_service_caller",
    "gui steer": "rqt_robot_steering",
    "gui topics": "rqt_topic",
    "gui world": "rviz",
    "launch": "roslaunch",
    "msg fingerprint": "rosmsg md5",
    "msg generate": "catkin build",
    "msg proto": "rosmsg-proto",
    "param describe": "ros2 param describe",
    "pkg build": "catkin build",
    "pkg create": "catkin_create_pkg",
    "pkg find": "rospack find",
    "pkg list": "rospack list",
    "plot": "rqt_plot",
    "run": "rosrun",
    "sim delete": "/gazebo/delete_model",
    "sim pause": "/gazebo/pause_physics",
    "sim reset": "/gazebo/reset_simulation",
    "sim resume": "/gazebo/unpause_physics",
    "sim set-pose": "/gazebo/set_model_state",
    "sim set-rate": "/gazebo/set_physics_properties",
    "sim spawn": "/gazebo/spawn_urdf_model",
    "sim state": "/gazebo/get_model_state",
    "sim step": "gz world --multi-step",
    "spy": "rqt_topic",
    "wtf": "roswtf",
}
"""By command, without "lcmtools"; a command that has none is left out."""
