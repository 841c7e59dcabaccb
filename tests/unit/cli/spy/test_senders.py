"""What senders are called, and how seldom the system is asked for it."""

import pytest

from lcmtools.bus.processes import Process
from lcmtools.observe.senders import SenderNames, program_name
from lcmtools.wire.packet import Sender

LOCAL, OTHER = Sender("127.0.0.1", 1), Sender("127.0.0.1", 2)


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("/usr/bin/lcm-source -m EXAMPLE", "lcm-source"),
        ("python3 -u /home/me/drive.py --fast", "drive.py"),
        ("/opt/v/bin/python3.11 /opt/v/bin/lcmtools run sim", "lcmtools"),
        ("python -m my.driver", "my.driver"),
        ("python3 -", "python3"),
        ("java -Dx=y -cp /opt/lcm.jar:. my.Driver fast", "my.Driver"),
        ("java -jar /opt/driver.jar", "driver.jar"),
        ("python -u -c import sys;exec(eval())", "python"),
        ("", "?"),
    ],
)
def test_a_program_is_called_by_its_file_or_its_script(command: str, name: str) -> None:
    assert program_name(command) == name


def test_a_process_is_looked_up_once_and_one_not_found_again_after_a_while() -> None:
    asked: list[set[int]] = []
    time = [0.0]

    def look_up(ports: set[int]) -> dict[int, Process]:
        asked.append(ports)
        return {1: Process(7, "drive")} if 1 in ports else {}

    names = SenderNames(look_up, lambda: time[0])
    for moment in (0.0, 1.0, 6.0):
        time[0] = moment
        names.learn([LOCAL, OTHER, None])
    assert asked == [{1, 2}, {2}]
    assert (names.name(LOCAL), names.name(OTHER)) == ("drive (pid 7)", "127.0.0.1:2")


def test_other_computers_are_not_looked_up() -> None:
    names = SenderNames(lambda _: pytest.fail("looked up"))
    names.learn([Sender("10.255.3.4", 5)])
    assert names.name(Sender("10.255.3.4", 5)) == "10.255.3.4:5"
