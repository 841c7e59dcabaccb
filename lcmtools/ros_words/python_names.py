"""Names of rospy and rclpy."""

MODULES = ("rospy", "rclpy")
FUNCTIONS = {
    **dict.fromkeys(("init_node", "create_node"), "lcmtools.init(), then lcmtools.Node('name')"),
    "Publisher": "node.create_publisher(Type, 'topic')",
    "Subscriber": "node.create_subscription(Type, 'topic', callback)",
    "Service": "node.create_service(Type, 'name', callback)",
    "ServiceProxy": "node.create_client(Type, 'name')",
    "Timer": "node.create_timer(seconds, callback)",
    **dict.fromkeys(("Rate", "sleep"), "rate = node.create_rate(10), then rate.sleep()"),
    "is_shutdown": "not lcmtools.ok()",
    **dict.fromkeys(("signal_shutdown", "on_shutdown"), "lcmtools.shutdown() after spin"),
    "get_param": "node.declare_parameter('name', default).value",
    "set_param": "node.set_parameters([lcmtools.Parameter('name', value)])",
    "wait_for_message": "next(lcmtools.observe.messages('/topic'))",
    "wait_for_service": "client.call(request, timeout), which waits",
    **dict.fromkeys(("logdebug", "loginfo"), "node.get_logger().info(text)"),
    "logwarn": "node.get_logger().warning(text)",
    **dict.fromkeys(("logerr", "logfatal"), "node.get_logger().error(text)"),
}
"""Functions and classes, with the code to write instead."""
METHODS = {
    **dict.fromkeys(("get_name", "get_fully_qualified_name"), "node.name"),
    "get_namespace": "node.namespace",
    "advertise": "node.create_publisher(Type, 'topic')",
    "subscribe": "node.create_subscription(Type, 'topic', callback)",
    "create_wall_timer": "node.create_timer(seconds, callback)",
    "spin": "lcmtools.spin(node)",
    "declare_parameters": "node.declare_parameter('name', default) for each",
    "get_param": "node.get_parameter('name').value",
    "set_parameter": "node.set_parameters([lcmtools.Parameter('name', value)])",
    **dict.fromkeys(("get_topic_names_and_types", "get_node_names"), "node.graph()"),
}
"""Methods of nodes, with the code to write instead."""
