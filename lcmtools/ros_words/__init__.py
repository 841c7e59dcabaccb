"""Names of ROS, and what takes their place here: tables, each for those who look up in it.

    commands      commands, and options of commands
    python_names  modules, functions and methods of rospy and rclpy
    launch_keys   keys of launch files
    field_types   types of the fields of .msg and .srv files

Belongs here: names and texts. Must not import anything.
"""
