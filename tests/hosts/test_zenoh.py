"""A bus of Zenoh between computers: who reaches whom, a line that is cut, TLS and passwords."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from fixtures.says import assert_says

_HERE, _NETWORK = "zenoh://", "zenoh://?interface=eth0"


def _talker(host, lcmtools_path, url, *words):
    talker = host.start(lcmtools_path, "run", "talker", *words, LCM_DEFAULT_URL=url)
    talker.wait_for("hello")
    return talker


def test_zenoh_stays_on_its_computer_unless_it_is_told_otherwise(pair, lcmtools_path):
    ada, bob = pair
    _talker(ada, lcmtools_path, _HERE, "__ns:=/quiet")
    _talker(ada, lcmtools_path, _NETWORK, "__ns:=/open")
    assert ada.out("node", "list", LCM_DEFAULT_URL=_HERE) == "/open/talker\n/quiet/talker\n"
    assert bob.lcmtools("node", "list", LCM_DEFAULT_URL=_HERE).stdout == ""
    assert bob.out("node", "list", LCM_DEFAULT_URL=_NETWORK) == "/open/talker\n"
    assert " * /open/talker (ada, pid " in bob.out(
        "info", "/open/chatter", LCM_DEFAULT_URL=_NETWORK
    )
    done = bob.lcmtools("list", LCM_DEFAULT_URL="zenoh://10.76.0.1:7447")
    assert (done.returncode, done.stdout) == (1, "")
    assert_says(done.stderr, "Zenoh", "10.76.0.1:7447", "Connection refused")


def test_a_cut_line_is_told_once_and_comes_back_by_itself(network, lcmtools_path):
    """All programs of ada may have the same URL: one listens, and another when that has ended."""
    net = network("ada", "bob")
    ada, bob = net.hosts
    first = _talker(ada, lcmtools_path, "zenoh://?listen=0.0.0.0:7447", "__ns:=/first")
    _talker(ada, lcmtools_path, "zenoh://?listen=0.0.0.0:7447", "__ns:=/second")
    url = f"zenoh://{ada.address}:7447"
    assert bob.out("node", "list", LCM_DEFAULT_URL=url) == "/first/talker\n/second/talker\n"
    echo = bob.start(lcmtools_path, "echo", "/second/chatter", LCM_DEFAULT_URL=url)
    echo.wait_for("hello")
    net.unplug(ada)
    echo.wait_for(f"the connection to {url} is lost")
    net.plug(ada)
    echo.wait_for(f"the connection to {url} is back")
    del echo.lines[:]
    echo.wait_for("hello")
    first.end()
    echo.wait_for(f"the connection to {url} is back")
    echo.wait_for("hello")
    assert "is lost" in echo.output
    echo.end()


def test_zenoh_with_tls_and_passwords_by_the_files_of_the_page(pair, lcmtools_path, tmp_path):
    ada, bob = pair
    signing, robot, office = _of_the_page(tmp_path, ada.address)
    if shutil.which("openssl") is None:
        pytest.skip("certificates are made with openssl, which is missing here")
    for words in (signing, signing.splitlines()[0].replace("authority.", "other.")):
        done = subprocess.run(
            ["/bin/sh", "-ec", words], cwd=tmp_path, capture_output=True, check=False
        )
        assert done.returncode == 0, done.stderr
    (tmp_path / "robot.json5").write_text(robot)
    _talker(ada, lcmtools_path, f"zenoh://{tmp_path}/robot.json5")

    def as_ada(old="", new=""):
        (tmp_path / "office.json5").write_text(office.replace(old, new))
        return bob.lcmtools("node", "list", LCM_DEFAULT_URL=f"zenoh://{tmp_path}/office.json5")

    assert as_ada().stdout == "/talker\n"
    refused = as_ada("secret", "wrong")
    assert refused.returncode == 1
    assert_says(refused.stderr, "10.76.0.1:7447", "user 'ada'", "password")
    assert "is not trusted" in as_ada("authority.pem", "other.pem").stderr
    assert "cannot read the certificate" in as_ada("authority.pem", "missing.pem").stderr
    plain = bob.lcmtools("list", LCM_DEFAULT_URL=f"zenoh://{ada.address}:7447")
    assert "10.76.0.1:7447 wants TLS" in plain.stderr


def _of_the_page(folder, address):
    """The commands that make certificates, and both files, for a folder and an address."""
    page = (Path(__file__).parents[2] / "docs/networks.md").read_text()
    page = page.replace("/etc/lcm", str(folder)).replace("192.168.1.7", address)
    blocks = re.findall(r"```\w+\n(.*?)```", page.partition("### TLS")[2], re.DOTALL)
    found = blocks[:3]
    return found
