"""The command lines of the labs' nodes."""

import importlib

import pytest
from fixtures.fake_bus import FakeBus

import lcmtools
import lcmtools.node.process
from lcmtools.errors import UsageError
from lcmtools.labs.nodes import check_command_line

NODES = ["talker", "listener", "moving_robot", "simple_controller", "evaluate_controller"]
NODES.append("reading_laser")
DRIVERS = ["teleop", "pioneer_manual_controller", "steering"]
ALL = [*NODES, *DRIVERS, "image_view", "kinect_viewer"]


@pytest.mark.parametrize("node", ALL)
@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_help_shows_topics_and_an_example_and_needs_no_bus(node, flag, monkeypatch, capsys):
    monkeypatch.setenv("LCM_DEFAULT_URL", "not a bus")
    importlib.import_module(f"lcmtools.labs.nodes.{node}").main([flag])
    text = capsys.readouterr().out
    assert text.partition("Example:")[2].count("lcmtools ") >= 2
    assert f"lcmtools run {node}" in text
    assert "scribes:\n" in text or "Publishes:\n" in text
    assert "__ns:=/husky0" in text


@pytest.mark.parametrize("node", NODES)
def test_unknown_argument_is_refused_before_there_is_a_bus(node, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", "not a bus")
    with pytest.raises(UsageError) as refusal:
        importlib.import_module(f"lcmtools.labs.nodes.{node}").main(["__ns:=/a", "--fast"])
    assert str(refusal.value) == "unknown argument '--fast'; --help shows what this node takes"
    assert refusal.value.exit_code == 2


def test_command_line_is_the_process_own_when_none_is_given(monkeypatch):
    monkeypatch.setattr("sys.argv", ["talker", "loudly"])
    with pytest.raises(UsageError, match="unknown argument 'loudly'"):
        check_command_line(None, "")


@pytest.mark.parametrize(
    "words", [[], ["__ns:=/husky0", "a:=b", "_kp:=2"], ["--ns", "/a", "-r", "a:=b", "--domain=3"]]
)
def test_names_parameters_and_the_bus_are_for_every_node(words):
    assert check_command_line(words, "")


@pytest.mark.parametrize("node", NODES)
def test_main_spins_one_node_of_its_name_and_leaves_the_bus(node, monkeypatch, tmp_path):
    spun = []
    monkeypatch.setenv("LCM_DEFAULT_URL", "memq://")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    monkeypatch.setattr("lcmtools.bus.udp_bus.UdpBus", lambda _url: FakeBus())
    monkeypatch.setattr(lcmtools, "spin", lambda node: spun.append(node.name), raising=False)
    assert importlib.import_module(f"lcmtools.labs.nodes.{node}").main(["__ns:=/husky0"]) is None
    assert spun == [f"/husky0/{node}"]
    assert not lcmtools.ok()
