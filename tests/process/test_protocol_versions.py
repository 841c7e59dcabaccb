"""Nodes of other versions of lcmtools on a bus: seen, asked and ended like any node."""

import json
import sys

import pytest
from fixtures import other_version

from lcmtools.graph.model import VERSION

_KINDS = ("newer", "older", "unreadable")
_PROGRAM = other_version.__file__


@pytest.fixture(params=["udpm", "tcpq", "zenoh"])
def any_bus(request, free_port, monkeypatch):
    """A bus of each kind, for all programs of the test."""
    url = {
        "udpm": lambda: f"udpm://239.255.76.67:{free_port()}?ttl=0",
        "tcpq": lambda: request.getfixturevalue("tcpq_server").url,
        "zenoh": lambda: f"zenoh://224.0.0.224:{free_port()}",
    }[request.param]()
    monkeypatch.setenv("LCM_DEFAULT_URL", url)
    return request.param


def _publishers(cli, topic):
    return {one["node"] for one in json.loads(cli("info", topic, "--json").out)[0]["publishers"]}


def test_nodes_of_other_versions_are_seen_and_answer(any_bus, start, cli):
    for kind in _KINDS:
        start(sys.executable, _PROGRAM, kind).wait_for("runs")
    names = {f"/{kind}_talker" for kind in _KINDS}
    assert set(cli("node", "list").out.split()) == names
    listed = cli("list").out.split()
    assert {"/chatter", "/cmd"} <= set(listed)
    # without senders a node whose details cannot be read has no topics
    unseen = set() if any_bus != "tcpq" else {"/unreadable_talker"}
    assert names - _publishers(cli, "/chatter") == unseen
    newer = json.loads(cli("node", "info", "newer_talker", "--json").out)[0]
    assert [one["topic"] for one in newer["subscriptions"]] == ["/cmd"]
    assert (newer["protocol_version"], newer["has_details"]) == (VERSION + 1, True)
    shown = cli("node", "info", "unreadable_talker").out
    assert f"Protocol: version {VERSION + 2} (lcmtools {VERSION + 2}.0.0)" in shown
    assert "In callbacks: not known" in shown
    drawn = cli("graph", "--all").out
    assert {name for name in names if name not in drawn} == set()
    for name in names:
        assert cli("node", "ping", name, "-c", "1").code == 0
        assert cli("node", "kill", name).code == 0
    assert cli("node", "list").out == ""


def test_a_newer_node_is_recorded_and_read_from_the_log(bus_url, start, cli, tmp_path, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    start(sys.executable, _PROGRAM, "newer").wait_for("runs")
    start(sys.executable, _PROGRAM, "unreadable").wait_for("runs")
    log = tmp_path / "ride.lcmlog"
    assert cli("bag", "record", "/chatter", "-o", str(log), "-n", "20").code == 0
    assert cli("node", "list", "-b", str(log)).out.split() == [
        "/newer_talker",
        "/unreadable_talker",
    ]
    described = json.loads(cli("info", "/chatter", "-b", str(log), "--json").out)
    assert {one["node"] for one in described[0]["publishers"]} == {
        "/newer_talker",
        "/unreadable_talker",
    }


def test_wtf_notes_the_versions_and_takes_no_node_for_stale(bus_url, start, cli, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    for kind in _KINDS:
        start(sys.executable, _PROGRAM, kind).wait_for("runs")
    findings = {one["rule"]: one for one in json.loads(cli("wtf", "--json").out)}
    assert "stale-nodes" not in findings
    assert "kill -KILL" not in json.dumps(findings)
    items = "\n".join(findings["other-version"]["items"])
    assert all(f"/{kind}_talker" in items for kind in _KINDS)
    assert findings["other-version"]["severity"] == "note"
