"""Reruns on a computer that is busy: all have one result, byte for byte."""

import subprocess
import sys
from pathlib import Path

import pytest

from lcmtools.bag.writer import LogWriter
from lcmtools.types.std_msgs import Float64
from lcmtools.wire.packet import Packet

_NODE = Path(__file__).parents[1] / "process/programs/played_to.py"
_START, _STEP = 1_700_000_000_000_000_000, 20_000_000  # [ns]


@pytest.fixture
def busy():
    """Two processes that take all the time they get."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]
    yield
    for loop in loops:
        loop.kill()
        loop.wait()


@pytest.mark.usefixtures("busy")
def test_reruns_beside_busy_loops_have_one_result(cli, tmp_path):
    log, launch = tmp_path / "in.lcmlog", tmp_path / "chain.yaml"
    with LogWriter(log) as writer:
        for n in range(100):
            writer.add(Packet("/in", Float64(data=float(n)).encode(), _START + n * _STEP))
    node = f"exec: {sys.executable}, args: {_NODE}"
    launch.write_text(
        f"nodes:\n- {{name: first, {node} __name:=first out:=middle _period:=0.05}}\n"
        f"- {{name: second, {node} __name:=second in:=middle}}\n"
    )
    results = set()
    for number in range(10):
        saved = tmp_path / f"{number}.lcmlog"
        words = ("bag", "rerun", str(log), "--save", str(saved), "--launch", str(launch))
        assert cli(*words).code == 1  # the log has no outputs
        results.add(saved.read_bytes())
    assert len(results) == 1
