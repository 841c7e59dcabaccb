"""lab skeleton: each node with TODOs is copied, runs as it is, and is never overwritten."""

import signal
import sys

import pytest
from fixtures.says import assert_line

from lcmtools.labs.skeletons import NAMES

pytestmark = pytest.mark.usefixtures("on_bus")


@pytest.mark.parametrize("name", NAMES)
def test_skeleton_runs_as_it_is_and_does_nothing_wrong(name, cli, start, tmp_path, wait_until):
    copied = cli("lab", "skeleton", name, str(tmp_path / "lab"))
    path = tmp_path / "lab" / f"{name}.py"
    assert (copied.code, copied.out) == (0, f"{path}\n")
    assert "TODO" in path.read_text()
    program = start(sys.executable, str(path))
    if name != "pioneer_manual_controller":  # which ends with its input
        wait_until(lambda: cli("node", "list").out == f"/{name}\n")
        program.send_signal(signal.SIGINT)
    assert program.wait() == 0
    # a viewer says so after a while, which a busy computer may need to see the node
    assert program.output in (
        "",
        "no node publishes /camera/depth/image_raw; lcmtools list shows all",
    )


def test_skeleton_is_overwritten_only_by_force(cli, tmp_path):
    mine = tmp_path / "moving_robot.py"
    mine.write_text("mine")
    words = ("lab", "skeleton", "moving_robot", str(tmp_path))
    refused = cli(*words)
    assert (refused.code, mine.read_text()) == (2, "mine")
    assert_line(refused.err, f"lcmtools lab skeleton: {mine}", "exists; --force")
    assert cli(*words, "--force").code == 0
    assert mine.read_text().startswith('"""Drive the Dolly in a circle (skeleton).')
