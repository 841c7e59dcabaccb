"""A bus of Zenoh between computers: who reaches whom, a line that is cut, TLS and passwords."""

import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

_HERE, _NETWORK = "zenoh://", "zenoh://?interface=eth0"


def _talker(host: Any, lcmtools_path: str, url: str, *words: str) -> Any:
    talker = host.start(lcmtools_path, "run", "talker", *words, LCM_DEFAULT_URL=url)
    talker.wait_for("hello")
    return talker


def test_zenoh_stays_on_its_computer_unless_it_is_told_otherwise(
    pair: Any, lcmtools_path: str
) -> None:
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
    assert "nothing of Zenoh at 10.76.0.1:7447 (Connection refused)" in done.stderr


def test_a_cut_line_is_told_once_and_comes_back_by_itself(
    network: Callable[..., Any], lcmtools_path: str
) -> None:
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


def test_zenoh_with_tls_and_passwords_by_a_configuration_file(
    pair: Any, lcmtools_path: str, tmp_path: Path
) -> None:
    ada, bob = pair
    _make_certificates(tmp_path)
    (tmp_path / "users").write_text("bob:secret\n")
    router = _write(
        tmp_path / "ada.json5",
        mode="peer",
        listen={"endpoints": ["tls/0.0.0.0:7447"]},
        tls={"listen_private_key": "ada.key", "listen_certificate": "ada.pem"},
        usrpwd={"user": "ada", "password": "x", "dictionary_file": str(tmp_path / "users")},
    )
    _talker(ada, lcmtools_path, f"zenoh://{router}")

    def as_user(password: str, trusted: str) -> Any:
        path = _write(
            tmp_path / "bob.json5",
            mode="client",
            connect={"endpoints": [f"tls/{ada.address}:7447"]},
            tls={"root_ca_certificate": trusted},
            usrpwd={"user": "bob", "password": password},
        )
        return bob.lcmtools("node", "list", LCM_DEFAULT_URL=f"zenoh://{path}")

    assert as_user("secret", "authority.pem").stdout == "/talker\n"
    refused = as_user("wrong", "authority.pem")
    assert refused.returncode == 1
    assert "10.76.0.1:7447 refuses the user 'bob' or the password" in refused.stderr
    assert "is not trusted" in as_user("secret", "other.pem").stderr
    assert "cannot read the certificate" in as_user("secret", "missing.pem").stderr
    plain = bob.lcmtools("list", LCM_DEFAULT_URL=f"zenoh://{ada.address}:7447")
    assert "10.76.0.1:7447 wants TLS" in plain.stderr


def _write(path: Path, **settings: Any) -> Path:
    files = {name: str(path.parent / file) for name, file in settings.pop("tls").items()}
    transport = {"link": {"tls": files}, "auth": {"usrpwd": settings.pop("usrpwd")}}
    scouting = {"multicast": {"enabled": False}}
    path.write_text(json.dumps({**settings, "transport": transport, "scouting": scouting}))
    return path


def _make_certificates(folder: Path) -> None:
    """Authorities "authority" and "other", and a certificate of ada by the first."""
    (folder / "names").write_text("subjectAltName=IP:10.76.0.1\n")
    for name in ("authority", "other"):
        files = f"-keyout {name}.key -out {name}.pem"
        _openssl(folder, f"req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN={name} {files}")
    _openssl(folder, "req -newkey rsa:2048 -nodes -subj /CN=ada -keyout ada.key -out ada.csr")
    signing = "-CA authority.pem -CAkey authority.key -CAcreateserial -days 2 -extfile names"
    _openssl(folder, f"x509 -req -in ada.csr {signing} -out ada.pem")


def _openssl(folder: Path, words: str) -> None:
    program = shutil.which("openssl")
    if program is None:
        pytest.skip("certificates are made with openssl, which is missing here")
    subprocess.run([program, *words.split()], cwd=folder, check=True, capture_output=True)
