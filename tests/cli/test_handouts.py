"""Every command of the three labs' texts, and its siblings of ROS, has an answer.

The answer is the command of lcmtools in its place, or an error that says what to type.
"""

import shlex
from pathlib import Path

import pytest

from lcmtools.cli.completion.tree import describe
from lcmtools.cli.ros import instead
from lcmtools.errors import UsageError

DOCS = Path(__file__).parents[2] / "docs"

WHEELS = "sensor_msgs/JointState \"name: ['left', 'right']\neffort: [1, 1]\""
TWIST = 'geometry_msgs/Twist "{ linear: [0.1, 0, 0], angular: [0.0, 0, 0.1] }"'
NAMES = "__ns:=/husky0 controlled_velocity:=velocity_cmd"

HUSKY = [
    ("module add /home/TDDE05/modulefiles/tdde05", "nothing to source or to load"),
    ("module initadd /home/TDDE05/modulefiles/tdde05", "nothing to source or to load"),
    ("load_ros", "nothing to source or to load"),
    ("catkin init", "lcmtools pkg create NAME"),
    ("catkin build", "pkg build"),
    ("roscore", "LCM has no master: start the nodes, for example lcmtools run sim"),
    ("roscd air_morse/worlds", "lcmtools lab start NAME"),
    ("morse run lab_0123_world.py", "lab start husky"),
    ("rostopic info /husky0/odometry", "topic info /husky0/odometry"),
    ("rostopic echo /husky0/odometry", "topic echo /husky0/odometry"),
    (f"rostopic pub /husky0/wheel_cmd {WHEELS}", f"topic pub /husky0/wheel_cmd {WHEELS}"),
    ("catkin_create_pkg air_lab0 roscpp rospy message_generation std_msgs",
     "pkg create air_lab0 --deps std_msgs"),
    ("catkin build air_lab0", "pkg build air_lab0"),
    ("rosrun air_lab0 simple_controller", "run air_lab0 simple_controller"),
    ("roswtf", "wtf"),
    ("rosnode info simple_controller", "node info simple_controller"),
    ("rosnode info morse", "node info morse"),
    (f"rosrun air_lab0 simple_controller {NAMES}", f"run air_lab0 simple_controller {NAMES}"),
    (f"rostopic pub /husky0/desired_velocity {TWIST}",
     f"topic pub /husky0/desired_velocity {TWIST}"),
    (f"rospub /husky0/desired_velocity {TWIST}", f"pub /husky0/desired_velocity {TWIST}"),
    ("roslaunch air_lab0 simple_controller.launch __ns:=/husky0",
     "launch air_lab0 simple_controller.launch __ns:=/husky0"),
    ("rqt", "lcmtools gui opens topics, plots, images, the graph and steering"),
    ("rosrun air_lab0 evaluate_controller.py", "run air_lab0 evaluate_controller.py"),
]  # fmt: skip
PIONEER = [
    ("roscore", "LCM has no master"),
    ("rosrun beginner_tutorials talker", "run beginner_tutorials talker"),
    ("rosnode list", "node list"),
    ("rostopic list", "topic list"),
    ("catkin_make", "pkg build"),
    ("roslaunch gazebo_ros empty_world.launch", "launch gazebo_ros empty_world.launch"),
    ("sudo apt-get install ros-indigo-joy", "no package of ROS needs to be installed"),
    ("apt-get install ros-indigo-joy", "no package of ROS needs to be installed"),
    ("roslaunch pre_assignment2 pre_assignment2.launch",
     "launch pre_assignment2 pre_assignment2.launch"),
    ("rosrun image_view image_view image:=/camera/depth/image_raw",
     "run image_view image:=/camera/depth/image_raw"),
]  # fmt: skip
DOLLY = [
    ("source ~/ros2_ws/install/setup.bash", "nothing to source or to load"),
    ("ros2 run my_package", "lcmtools pkg create my_package creates it"),
    ("ros2 run my_package moving_robot", "run my_package moving_robot"),
    ("ros2 topic list", "topic list"),
    ("ros2 pkg create --build-type ament_cmake my_package --dependencies rclcpp geometry_msgs",
     "pkg create my_package --cpp --deps geometry_msgs"),
    ("colcon build --packages-select my_package", "pkg build my_package"),
    ("gazebo", "lcmtools gui world shows the robots"),
]  # fmt: skip
SIBLINGS = [
    ("catkin_create_pkg -l MIT -a Me --rosdistro=noetic a rospy", "pkg create a --license MIT"),
    ("ros2 pkg create --build-type=ament_python --node-name drive --license MIT a",
     "pkg create a --node drive --license MIT"),
    ("ros2 pkg create a --build-type=ament_cmake", "pkg create a --cpp"),
    ("catkin_create_pkg a std_msgs rospy roscpp", "pkg create a --deps std_msgs"),
    ("ros2 pkg create a --destination-directory src", "pkg create a src"),
    ("catkin list", "pkg list"),
    ("catkin locate air_lab0", "pkg find air_lab0"),
    ("catkin clean", "lcmtools pkg build checks its messages"),
    ("catkin_make install", "pkg build"),
    ("catkin_make --pkg air_lab0", "pkg build air_lab0"),
    ("colcon list", "pkg list"),
    ("colcon test", "pytest runs a package's tests"),
    ("roscd air_lab0/src", 'type: cd "$(lcmtools pkg find air_lab0)/src"'),
    ("rosls air_lab0", 'ls "$(lcmtools pkg find NAME)"'),
    ("rosed air_lab0 a.py", "lcmtools pkg find NAME"),
    ("rosmake", "pkg build"),
    ("rosbag play ride.lcmlog", "bag play ride.lcmlog"),
    ("rosparam list", "param list"),
    ("rosmsg show Twist", "msg show Twist"),
    ("rosservice list", "service list"),
    ("rospack list", "pkg list"),
    ("rviz", "lcmtools gui world shows the robots"),
    ("rqt_plot /odometry", "lcmtools gui plot TOPIC/FIELD"),
    ("rqt_graph", "graph"),
    ("rosrun rqt_robot_steering rqt_robot_steering", "lcmtools gui steer TOPIC"),
    ("rosrun tf tf_echo a b", "lcmtools echo /tf"),
    ("rosrun tf2_ros static_transform_publisher", "/tf tf2_msgs/TFMessage"),
    ("gz sim", "lcmtools gui world shows the robots"),
    ("morse create a", "lcmtools lab start NAME"),
    *((f"ros2 {words}", words) for words in (
        "node list", "interface show std_msgs/msg/String", "param list", "service list",
        "bag info ride.lcmlog", "launch air_lab0 a.yaml", "doctor", "pkg list",
    )),
    *((f"ros2 {words}", hint) for words, hint in (
        ("action list", "no actions"), ("component list", "lcmtools run"),
        ("daemon stop", "there is none"), ("lifecycle list", "lcmtools run"),
        ("multicast send", "lcmtools wtf"), ("security x", "no security"),
        ("test a", "pytest"),
    )),
]  # fmt: skip


def translate(typed):
    """The command in place of one of ROS, or the error that there is none."""
    try:
        return instead("", shlex.split(typed)), ""
    except UsageError as error:
        return [], str(error)


TEXTS = [*HUSKY, *PIONEER, *DOLLY]


@pytest.mark.parametrize(("typed", "answer"), dict.fromkeys([*TEXTS, *SIBLINGS]))
def test_every_command_has_an_answer(typed, answer):
    words, hint = translate(typed)
    if not words:
        assert answer in hint
        return
    assert words == shlex.split(answer)
    command = describe(words[:1])
    assert command is not None
    assert not command.commands or words[1] in command.commands


@pytest.mark.parametrize("word", sorted({typed.split()[0] for typed, _ in TEXTS}))
def test_every_command_of_the_texts_is_on_a_page(word):
    pages = (DOCS / f"coming-from-ros{number}.md" for number in (1, 2))
    assert any(f"`{word}" in page.read_text() for page in pages)
