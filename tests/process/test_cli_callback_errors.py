"""Errors of a node's callbacks are shown where the node and its topics are looked at."""

import json
import re
import sys

import pytest

_PROGRAM = """\
import lcmtools
from lcmtools.types.nav_msgs import Odometry

class Controller(lcmtools.Node):
    def __init__(self):
        super().__init__("controller")
        self.create_publisher(Odometry, "odometry", 10)
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.missing.publish(1)

lcmtools.init()
lcmtools.spin(Controller())
"""
_WORDS = "timer 0.02 s raised AttributeError"
_PLACE = "my_controller.py:11: 'Controller' object has no attribute 'missing'"


pytestmark = pytest.mark.usefixtures("use_module_bus", "program")


@pytest.fixture(scope="module")
def program(module_start, tmp_path_factory):
    script = tmp_path_factory.mktemp("mine") / "my_controller.py"
    script.write_text(_PROGRAM)
    module_start(sys.executable, str(script), "__ns:=/husky0").wait_for("AttributeError")


def test_node_info_shows_the_errors_of_callbacks(cli):
    shown = cli("node", "info", "controller").out
    assert f"Errors of callbacks:\n * {_WORDS} " in shown
    assert re.search(rf"(once|\d+ times), {re.escape(_PLACE)}", shown)
    (record,) = json.loads(cli("node", "info", "controller", "--json").out)
    (error,) = record["callback_errors"]
    assert (error["exception"], error["place"]) == ("AttributeError", "my_controller.py:11")
    assert error["count"] > 0


def test_spy_names_the_nodes_whose_callbacks_raise(cli):
    said = cli("spy", "--once", "--wait", "300ms").err
    assert f"lcmtools spy: /husky0/controller: {_WORDS} " in said
    assert _PLACE in said
