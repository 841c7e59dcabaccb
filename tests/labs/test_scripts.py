"""The three labs from their scripts, as a student would do them."""

import os
import re
import signal
import socket
import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.usefixtures("quiet_network")
LABS = Path(__file__).parents[2] / "labs"
LEAST_CHECKS = {"husky": 25, "pioneer": 24, "dolly": 16}


def free_domain():
    """A domain whose bus nobody is on, among those of this worker of the tests."""
    worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
    for domain in range(100 + worker % 8 * 16, 116 + worker % 8 * 16):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", 7667 + domain))
            except OSError:
                continue
            return str(domain)
    pytest.fail("no free domain")


def environment(lcmtools_path, tmp_path):
    return {
        "PATH": f"{Path(lcmtools_path).parent}:{os.environ['PATH']}",
        "LCMTOOLS_DOMAIN": free_domain(),
        "TMPDIR": str(tmp_path),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),  # nothing is noted there
    }


@pytest.mark.parametrize("lab", LEAST_CHECKS)
def test_everything_in_the_lab_works(lab, lcmtools_path, tmp_path, left_over):
    result = subprocess.run(
        ["bash", str(LABS / lab / "lab.sh")],  # noqa: S607 - bash is where the system has it
        env={**os.environ, **environment(lcmtools_path, tmp_path)},
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )
    said = result.stdout + result.stderr
    checks = re.findall(r"^(ok|FAILED) +(.*)$", result.stdout, re.MULTILINE)
    assert [text for verdict, text in checks if verdict != "ok"] == [], said
    assert len(checks) >= LEAST_CHECKS[lab], said
    assert result.returncode == 0, said
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []  # it cleans up after itself
    assert left_over() == []


def test_a_lab_that_is_broken_off_leaves_nothing_behind(
    lcmtools_path, tmp_path, start, left_over, wait_until
):
    script = str(LABS / "husky" / "lab.sh")
    lab = start("bash", script, **environment(lcmtools_path, tmp_path))
    lab.wait_for("/husky0/odometry", 60.0)
    lab.send_signal(signal.SIGTERM)
    assert lab.wait(30.0) == 143
    wait_until(lambda: left_over() == [])
    assert list(tmp_path.iterdir()) == []


def test_a_lab_whose_simulator_does_not_start_says_so_and_fails(lcmtools_path, tmp_path, left_over):
    fake = tmp_path / "bin"
    fake.mkdir()
    (fake / "lcmtools").write_text(
        f'#!/bin/sh\n[ "$1" = run ] && {{ echo broken; exit 1; }}\nexec {lcmtools_path} "$@"\n'
    )
    (fake / "lcmtools").chmod(0o755)
    settings = environment(lcmtools_path, tmp_path)
    result = subprocess.run(
        ["bash", str(LABS / "dolly" / "lab.sh")],  # noqa: S607
        env={**os.environ, **settings, "PATH": f"{fake}:{settings['PATH']}"},
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert result.returncode == 1
    assert "the simulator did not start:\nbroken" in result.stderr
    assert left_over() == []
