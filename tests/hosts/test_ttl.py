"""ttl=0 keeps a program's messages on its computer; wtf says who is not heard elsewhere."""

import json

import pytest

_STAYS = "udpm://239.255.76.67:7667?ttl=0"


def _ttl_findings(host):
    found = json.loads(host.lcmtools("wtf", "--json", "--wait", "0.7s").stdout)
    return [one["items"] for one in found if one["rule"] == "ttl"]


@pytest.mark.parametrize(("here", "there"), [(0, 1), (1, 0)], ids=["one way", "the other"])
def test_ttl_0_stays_on_its_computer(pair, lcmtools_path, here, there):
    sender, other = pair[here], pair[there]
    talker = sender.start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=_STAYS)
    talker.wait_for("hello")
    assert sender.out("list").split() == ["/chatter", "/rosout"]
    assert other.out("list") == ""
    assert other.out("node", "list") == ""
    waited = other.lcmtools("echo", "/chatter", "-n", "1", "--timeout", "0.5s")
    assert (waited.returncode, waited.stdout) == (4, "")


def test_wtf_names_who_cannot_be_heard_by_the_others(pair, lcmtools_path):
    ada, bob = pair
    talker = ada.start(lcmtools_path, "run", "talker", LCM_DEFAULT_URL=_STAYS)
    bob.start(lcmtools_path, "run", "talker", "__name:=other").wait_for("hello")
    talker.wait_for("hello")
    found = json.loads(ada.lcmtools("wtf", "--json", "--wait", "0.7s").stdout)
    (finding,) = [one for one in found if one["rule"] == "ttl"]
    assert finding["text"].startswith("Other computers (10.76.0.2) cannot receive")
    assert finding["items"] == ["/talker"]
    assert finding["remedies"][0].endswith("7667?ttl=1")
    talker.end()
    ada.start(lcmtools_path, "run", "talker").wait_for("hello")
    assert _ttl_findings(ada) == []


def test_commands_that_begin_meanwhile_are_not_taken_for_ttl_0(pair, lcmtools_path, plain):
    """They test the bus with a datagram that stays on the computer, whatever the URL says."""
    ada, bob = pair
    bob.python(plain, "FAR", "8", "0.05").wait_for("sends")
    again = f"while true; do {lcmtools_path} node list; done"
    ada.start("sh", "-c", again).wait_for("no nodes")
    assert _ttl_findings(ada) == []


def test_commands_that_begin_are_no_programs_on_the_bus(pair, lcmtools_path, wait_until):
    ada, _ = pair
    again = f"while true; do {lcmtools_path} config; {lcmtools_path} node list; done"
    loop = ada.start("sh", "-c", again)
    loop.wait_for("no nodes")
    before = len(loop.lines)
    assert "LCM_SELF_TEST" not in ada.out("node", "list", "-a", "--wait", "1s")
    wait_until(lambda: len(loop.lines) > before)
