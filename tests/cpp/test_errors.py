"""Errors of the headers that nobody catches: one line, exit code 1, and no node is left behind."""

import re
import signal

import pytest
from fixtures.says import assert_says

from lcmtools.packages.cmake import cpp_folder

CASES = {
    "unknown": "/faulty has no parameter 'gian'; it has gain, use_sim_time",
    "twice": "/faulty declares its parameter 'gain' twice",
    "kind": "/faulty: the parameter 'gain' is float, not int; write as_double()",
    "list": "the parameter 'names' is string[], not float; write as<std::vector<std::string>>()",
    "range": "parameter speed: 5 is more than 1",
    "lines": r"no parameter 'a\x0ab\x1b[2J'",
    "topic": "'a b' is not a legal name",
    "empty": "the topic is empty",
    "long": "71 bytes",
    "plain": "70 bytes",
    "service": "71 bytes",
    "client": "68 bytes",
    "period": "a timer's period must be positive",
    "rate": "a rate must be positive",
    "node": "'a b' is not a legal node name",
    "init": "lcmtools::init() was called twice",
    "nobody": "/nobody did not answer within 0.1 s; see whether its node runs",
    "length": "data has 2 elements, but its length is 0; set the length that belongs to it",
    "nested": "dim has 0 elements, but its length is 3; set the length that belongs to it",
    "idle": "/own did not answer within 0.1 s: its node /faulty is in this program",
}


@pytest.fixture
def fault(node_program, start, bus_url, monkeypatch):
    """``fault(case, place)``: the program errors.cpp."""
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    return lambda *words: start(str(node_program.with_name("errors")), *words)


@pytest.mark.parametrize("place", ["main", "constructor"])
@pytest.mark.parametrize("case", CASES)
def test_it_is_one_line(case, place, fault, cli):
    program = fault(case, place)
    assert program.wait() == 1
    (line,) = program.lines
    assert_says(line, "error: ", CASES[case])
    assert "/faulty" not in str(cli("node", "list"))


def test_on_another_thread_it_ends_the_program(fault):
    program = fault("unknown", "thread")
    assert program.wait() == 1
    assert program.lines == [f"error: {CASES['unknown']}"]


def test_before_init_it_is_one_line(fault):
    program = fault("topic", "early")
    assert program.wait() == 1
    assert program.lines == ["error: there is no bus yet; call lcmtools::init(argc, argv) first"]


@pytest.mark.parametrize("case", ["unknown", "twice", "idle"])
def test_in_a_timer_it_is_logged_and_a_signal_ends_the_program(case, fault):
    program = fault(case, "timer")
    assert_says(program.wait_for("timer 0.05 s raised"), CASES[case], "errors.cpp:")
    program.send_signal(signal.SIGTERM)
    assert program.wait() == 0


def test_none_is_thrown_while_a_mutex_is_held():
    """The program's end takes it again: a block with a lock has no ``throw`` before ``unlock``."""
    headers = (cpp_folder() / "lcmtools").glob("*.hpp")
    for header in headers:
        for scope in re.findall(r"const std::lock_guard [^}]*", header.read_text()):
            assert "throw " not in scope, f"{header.name}: {scope}"
