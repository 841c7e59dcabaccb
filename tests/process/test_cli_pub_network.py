"""pub while the network is gone: what repeats goes on, what is to send so many fails."""

import pytest
from fixtures.says import assert_says

ROUTE = ("224.0.0.0/4", "dev", "lo")
CUT = [("link", "set", "lo", "down")]
MENDED = [("link", "set", "lo", "up"), ("route", "add", *ROUTE)]
MESSAGE = ("/chatter", "std_msgs/String", "hello")
CANNOT = "lcmtools pub: cannot publish on /chatter: Network is unreachable"
WAITING = f"{CANNOT}; waiting for the network"
AGAIN = "lcmtools pub: messages are sent again"

pytestmark = pytest.mark.usefixtures("on_bus", "private_network")


def test_a_pub_that_repeats_goes_on_when_the_network_is_back(cli, ip):
    steps = iter([("publishing #2", CUT), (WAITING, MENDED)])
    step = [next(steps, None)]

    def is_back(written):
        if step[0] and step[0][0] in written:
            for words in step[0][1]:
                ip(*words)
            step[0] = next(steps, None)
        _, again, after = written.partition(AGAIN)
        return bool(again) and after.count("publishing #") > 10

    result = cli("pub", "-v", "-w", "0", "-r", "50", *MESSAGE, until=is_back)
    assert result.code == 130
    assert result.err.count(WAITING) == 1


def test_a_pub_of_so_many_fails(cli, ip):
    is_gone = []

    def cut_off(written):
        if "publishing #2" in written and not is_gone:
            is_gone.append(True)
            ip(*CUT[0])
        return False

    words = ("-v", "-w", "0", "-r", "50", "-t", "100000")
    result = cli("pub", *words, *MESSAGE, until=cut_off)
    assert result.code == 1
    assert result.err.splitlines()[-1] == CANNOT


def test_once_fails_with_one_line(cli, ip):
    ip(*CUT[0])
    result = cli("pub", "-1", *MESSAGE)
    assert result.code == 1
    (line,) = result.err.splitlines()
    assert_says(line, "lcmtools pub: ", "multicast", "239.255.76.67")
