"""teleop, pioneer_manual_controller and steering: from terminals and pipes, to the last zero."""

import signal
import threading

import lcm
import pytest
from fixtures.typist import Typist

from lcmtools.types.geometry_msgs import Twist, TwistStamped


class Robot:
    """Receives all commands on a bus."""

    def __init__(self, url, topic):
        self.received = []
        self._bus = lcm.LCM(url)
        self._bus.subscribe(topic, self._receive)
        self._goes_on = True
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def close(self):
        """Receive no more."""
        self._goes_on = False
        self._thread.join()

    def _listen(self):
        while self._goes_on:
            self._bus.handle_timeout(50)

    def _receive(self, _channel, payload):
        try:
            twist = Twist.decode(payload)
        except ValueError:
            twist = TwistStamped.decode(payload).twist
        self.received.append((round(twist.linear.x, 3), round(twist.angular.z, 3)))


@pytest.fixture
def listen(bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    robots = []

    def make(topic):
        robots.append(Robot(bus_url, topic))
        return robots[-1]

    yield make
    for robot in robots:
        robot.close()


@pytest.fixture
def typist(lcmtools_path):
    typists = []

    def sit_down(*words):
        typists.append(Typist(lcmtools_path, "run", *words))
        return typists[-1]

    yield sit_down
    for one in typists:
        one.close()


def without_repeats(received):
    return [one for before, one in zip([None, *received], received, strict=False) if one != before]


def test_keys_from_a_pipe_are_published_one_by_one_and_end_with_zeros(listen, cli, wait_until):
    robot = listen("/cmd_vel")
    result = cli("run", "teleop", input="i q z l I J . k\n")
    assert result.code == 0
    wait_until(lambda: len(robot.received) >= 11)
    assert robot.received[:8] == [
        (0.5, 0.0), (0.55, 0.0), (0.495, 0.0), (0.0, -0.99), (0.495, 0.0), (0.0, 0.99),
        (-0.495, 0.99), (0.0, 0.0),
    ]  # fmt: skip
    assert set(robot.received[8:]) == {(0.0, 0.0)}


def test_waits_in_a_pipe_are_kept_and_the_command_repeated(listen, cli, wait_until):
    robot = listen("/RosAria/cmd_vel")
    cli("run", "pioneer_manual_controller", "_speed:=0.3", input="i 1 l")
    wait_until(lambda: robot.received[-3:] == [(0.0, 0.0)] * 3)
    assert without_repeats(robot.received) == [(0.3, 0.0), (0.0, -1.0), (0.0, 0.0)]
    assert 6 <= robot.received.count((0.3, 0.0)) <= 12


def test_stamped_commands_go_to_the_remapped_topic(listen, cli, wait_until):
    robot = listen("/a/b")
    cli("run", "teleop", "--stamped", "__ns:=/a", "cmd_vel:=b", input="u")
    wait_until(lambda: len(robot.received) >= 4)
    assert without_repeats(robot.received) == [(0.5, 1.0), (0.0, 0.0)]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGHUP, signal.SIGQUIT])
def test_every_ending_signal_stops_the_robot_and_restores_the_terminal(
    number, listen, typist, wait_until
):
    robot = listen("/cmd_vel")
    driver = typist("teleop")
    driver.wait_for("v +0.00")
    assert driver.settings() != driver.before
    driver.type("i")
    wait_until(lambda: robot.received.count((0.5, 0.0)) >= 3)
    driver.process.send_signal(number)
    driver.process.send_signal(number)  # impatience changes nothing
    assert driver.end() == 0
    assert driver.settings() == driver.before
    wait_until(lambda: robot.received[-3:] == [(0.0, 0.0)] * 3)


def test_the_first_lines_of_log_come_before_the_status_line(typist):
    driver = typist("pioneer_manual_controller")
    driver.wait_for("v +0.00")
    assert b"lcmtools' own pioneer_manual_controller" in driver.written.partition(b"v +0.00")[0]


@pytest.mark.parametrize("last_key", ["\x04", "hang up"])
def test_end_of_the_terminal_stops_the_robot(last_key, listen, typist, wait_until):
    robot = listen("/RosAria/cmd_vel")
    driver = typist("pioneer_manual_controller")
    driver.wait_for("v +0.00")
    driver.type("\x1b[A")  # the arrow up
    wait_until(lambda: (0.5, 0.0) in robot.received)
    if last_key == "hang up":
        driver.hang_up()
        driver.process.wait(40)
    else:
        driver.type(last_key)
        assert driver.end() == 0
    wait_until(lambda: robot.received[-3:] == [(0.0, 0.0)] * 3)


def test_key_that_is_held_drives_and_one_that_is_let_go_stops(listen, typist, wait_until):
    robot = listen("/cmd_vel")
    driver = typist("teleop", "--hold")
    driver.wait_for("v +0.00")
    driver.type("i")
    wait_until(lambda: robot.received[-1:] == [(0.5, 0.0)])
    wait_until(lambda: robot.received[-3:] == [(0.0, 0.0)] * 3)
    assert driver.process.poll() is None


def test_suspended_program_stops_the_robot_and_gives_the_terminal_back(listen, typist, wait_until):
    robot = listen("/cmd_vel")
    driver = typist("teleop")
    driver.wait_for("v +0.00")
    driver.type("i")
    wait_until(lambda: (0.5, 0.0) in robot.received)
    driver.process.send_signal(signal.SIGTSTP)
    # a session of its own is an orphaned group, which the kernel does not stop: it goes on at once
    wait_until(lambda: robot.received[-3:] == [(0.0, 0.0)] * 3)
    driver.process.send_signal(signal.SIGCONT)
    driver.type("j")
    wait_until(lambda: robot.received[-1] == (0.0, 1.0))
