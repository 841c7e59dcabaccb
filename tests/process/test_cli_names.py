"""Namespaces, remaps and patterns mean the same to commands that look as to nodes."""

import json

import pytest

from lcmtools.labs.nodes.talker import Talker

NAMESPACE = ("__ns:=/a", "--ns=a")


@pytest.fixture(autouse=True)
def _talkers(bus_url, start_node, monkeypatch):
    """A talker in the namespace /a, and one in /b/c."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    for namespace in ("/a", "/b/c"):
        start_node(Talker, f"__ns:={namespace}")


@pytest.mark.parametrize("namespace", NAMESPACE)
def test_a_relative_name_is_read_in_the_namespace(cli, namespace):
    for verb in ("echo", "hz", "bw"):
        assert cli(verb, "chatter", namespace, "-n", "1", "--timeout", "10s").code == 0
    for verb in ("type", "info", "list"):
        assert "/a/" in cli(verb, "chatter", namespace, "--json").ok()
    assert "Node [/a/talker]" in cli("node", "info", "talker", namespace).ok()
    assert cli("node", "list", "talker", namespace).ok() == "/a/talker\n"
    assert cli("param", "list", "talker", namespace).ok() == "/a/talker/use_sim_time\n"
    assert cli("service", "list", "-a", "--json", namespace, "talker").ok() != "[]\n"
    assert "/b" not in cli("graph", "talker", namespace).out
    assert '"/b' not in cli("spy", "--json", "--wait", "0.2", "chatter", namespace).ok()


@pytest.mark.parametrize("remap", ["news:=/a/chatter", "--remap=/news:=a/chatter"])
def test_a_remapped_name_is_looked_at_in_place_of_another(cli, remap):
    assert "hello" in cli("echo", "news/data", remap, "-n", "1", "--timeout", "10s").ok()
    assert json.loads(cli("hz", "news", remap, "-n", "1", "--json").out)["topic"] == "news"
    assert cli("type", "/news", remap).ok() == "std_msgs/String\n"
    assert cli("list", "news", remap).ok() == "/a/chatter\n"


def test_what_is_said_to_nodes_only_is_refused(cli):
    for word in ("_gain:=2", "__name:=x", "__what:=x"):
        result = cli("echo", "/a/chatter", word)
        assert (result.code, word in result.err) == (2, True)


def test_after_two_dashes_nothing_is_a_remap(cli):
    assert "no topics in a:=b" in cli("list", "--", "a:=b").err


@pytest.mark.parametrize(
    ("pattern", "topics"),
    [("/*/chatter", "/a/chatter\n"), ("/**/chatter", "/a/chatter\n/b/c/chatter\n")],
)
def test_a_pattern_has_one_meaning_in_all_commands(cli, pattern, topics):
    assert cli("list", pattern).ok() == topics
    echoed = cli("echo", pattern, "-n", "40", "--json", "--timeout", "10s").out
    assert ("/b/c/chatter" in echoed) == ("/b/c/chatter" in topics)
    spied = cli("spy", "--json", "--wait", "0.2", pattern).ok()
    assert ("/b/c/chatter" in spied) == ("/b/c/chatter" in topics)
