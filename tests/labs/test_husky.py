"""The first lab, from its script, as a student would do it."""

import os
import re
import socket
import subprocess
from pathlib import Path

import pytest

LAB = Path(__file__).parents[2] / "labs" / "husky.sh"
CHECKS = LAB.read_text().count("\ncheck '")


def free_domain() -> str:
    """A domain whose bus nobody is on."""
    for domain in range(100, 232):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", 7667 + domain))
            except OSError:
                continue
            return str(domain)
    pytest.fail("no free domain")


def test_everything_in_the_lab_works(lcmtools_path: str, tmp_path: Path) -> None:
    environment = {
        "PATH": f"{Path(lcmtools_path).parent}:{os.environ['PATH']}",
        "LCMTOOLS_DOMAIN": free_domain(),
        "TMPDIR": str(tmp_path),
    }
    result = subprocess.run(
        ["bash", str(LAB)],  # noqa: S607 - bash is where the system has it
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    said = result.stdout + result.stderr
    checks = re.findall(r"^(ok|FAILED) +(.*)$", result.stdout, re.MULTILINE)
    assert [text for verdict, text in checks if verdict != "ok"] == [], said
    assert len(checks) == CHECKS > 10, said
    assert result.returncode == 0, said
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []  # it cleans up after itself
