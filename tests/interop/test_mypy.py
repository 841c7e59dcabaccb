"""mypy knows the fields of every message by the stubs."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

SNIPPET = """\
from collections.abc import Callable
from typing import TypeVar

from lcmtools.types.geometry_msgs import Twist, Vector3
from lcmtools.types.lcmtools_msgs import Endpoint
from lcmtools.types.nav_msgs import Path
from lcmtools.types.sensor_msgs import Image, JointState
from lcmtools.types.service import Service
from lcmtools.types.std_srvs import SetBool, Trigger
from lcmtools.types.visualization_msgs import Marker

RequestT = TypeVar("RequestT")
ResponseT = TypeVar("ResponseT")


def serve(
    pair: type[Service[RequestT, ResponseT]], answer: Callable[[RequestT], ResponseT]
) -> ResponseT:
    return answer(pair.Request())


def trigger(request: Trigger.Request) -> Trigger.Response:
    response = Trigger.Response()
    response.success = True
    return response


twist = Twist()
twist.linear.x = 1
twist.linear = Vector3()
path = Path()
path.poses[0].pose.position.x = 2.0
joints = JointState()
joints.name.append("left")
joints.effort = (0.5,)
joints.effort = [0.5]
image = Image()
image.data = b"pixels"
endpoint = Endpoint.decode(Endpoint().encode())
endpoint.bytes = Endpoint.CLIENT
text: str = serve(Trigger, trigger).message
twist = Twist(linear=Vector3(x=1.0), angular=Vector3(0.0, 0.0, 1.0))
same: bool = twist == Twist()
joints = JointState(name=["left"], position=(0.5,))
endpoint = Endpoint(bytes=3)
Vector3(q=1)  # wrong
Vector3(x="a")  # wrong
twist.linear.x = "a"  # wrong
twist.lineaar = Vector3()  # wrong
JointState().effort.append(0.5)  # wrong
image.data = [1, 2]  # wrong
Marker.ADD = 4  # wrong
endpoint.bytes = b""  # wrong
serve(SetBool, trigger)  # wrong
"""


def test_mypy_accepts_what_is_right_and_names_what_is_wrong(tmp_path):
    snippet = tmp_path / "snippet.py"
    snippet.write_text(SNIPPET)
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--no-error-summary"]
    command.append("--follow-imports=silent")  # it is about the types
    checked = subprocess.run(
        [*command, f"--cache-dir={tmp_path / 'cache'}", str(snippet), str(ROOT / "lcmtools/types")],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(ROOT)},
        check=False,
    )
    errors = [line for line in checked.stdout.splitlines() if ": error: " in line]
    wrong = [i for i, line in enumerate(SNIPPET.splitlines(), 1) if line.endswith("# wrong")]
    assert [line.split(":")[:2] for line in errors] == [["snippet.py", str(i)] for i in wrong]
