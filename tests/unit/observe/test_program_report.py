"""Programs that are no nodes, as the node commands show them."""

import pytest

from lcmtools.bus.processes import Process
from lcmtools.bus.sockets import UdpSocket
from lcmtools.observe.node_requests import program_names
from lcmtools.observe.reading.senders import Program
from lcmtools.observe.reports.program_report import command_text, listed_rows, to_json

JAVA = (Process(5, "java A"), Process(7, "java B"))


def _program(process=None, drops=0, **values):
    sockets = (UdpSocket("239.255.76.67", 7667, 1, 0, drops),)
    return Program(process, "ada", "10.0.0.1", (7667,), (), listens=True, sockets=sockets, **values)


def test_whose_a_shared_port_may_be_is_said_and_not_guessed():
    program = _program(candidates=JAVA)
    assert command_text(program) == "a program: maybe A (pid 5) or B (pid 7)"
    found = to_json(program)
    assert (found["pid"], found["candidates"]) == (None, [5, 7])


def test_of_a_program_of_which_nothing_is_known_nothing_is_said():
    assert command_text(_program()) == "a program"


@pytest.mark.parametrize(
    ("drops", "text"), [(0, "listens"), (12, "listens (12 datagrams dropped so far)")]
)
def test_what_a_listener_has_lost_stands_beside_it(drops, text):
    assert listed_rows(_program(JAVA[0], drops))[1] == f"\t{text}"
    assert to_json(_program(JAVA[0], drops))["drops"] == drops


def test_a_program_without_a_process_is_meant_by_its_address():
    assert program_names(_program()) == {"10.0.0.1:7667"}
