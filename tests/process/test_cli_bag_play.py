"""bag play: what reaches the bus, what is refused, and what is said of commands that stand."""

import re
import shlex
import signal
import subprocess
import threading

import lcm
import pytest
from fixtures.says import assert_says
from fixtures.typist import Typist
from fixtures.wire import encode_event

from lcmtools import Node
from lcmtools.bag.writer import LogWriter
from lcmtools.bus.udp_sender import PACED_ABOVE_BYTES
from lcmtools.graph.model import Endpoint, NodeInfo, Role
from lcmtools.graph.protocol import Announcement, encode_announcement
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Twist
from lcmtools.types.nav_msgs import Odometry
from lcmtools.wire.log_events import packets
from lcmtools.wire.log_index import RecordedNode
from lcmtools.wire.packet import Packet, Sender

S = 1_000_000_000
START = 1_795_000_000 * S
ODOMETRY = encode(Odometry())
PLAIN = b"\0\1\2 no LCM message \xff"


def twist(forward):
    message = Twist()
    message.linear.x = forward
    return encode(message)


@pytest.fixture
def log(tmp_path):
    """``log(("/a", 0.1, payload), ...)``: the path of a log with messages at seconds."""

    def write(*messages):
        path = tmp_path / "ride.lcmlog"
        found = [Packet(channel, data, START + round(time * S)) for channel, time, data in messages]
        path.write_bytes(b"".join(encode_event(n, one) for n, one in enumerate(found)))
        return str(path)

    return write


@pytest.fixture
def ride(log):
    """A log of a drive."""
    return log(
        *(
            (topic, time / 10, payload)
            for time in range(5)
            for topic, payload in (("/cmd_vel", twist(0.5)), ("/odom", ODOMETRY))
        )
    )


class Listener:
    """Receives all messages on a bus, as a plain LCM program does."""

    def __init__(self, url):
        self.received = []
        self._bus = lcm.LCM(url)
        self._bus.subscribe("[^#].*", self._receive)
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

    def _receive(self, channel, payload):
        if not channel.startswith(("/_lcmtools", "LCM_SELF_TEST")):
            self.received.append((channel, payload))


@pytest.fixture
def listener(bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    one = Listener(bus_url)
    yield one
    one.close()


class Robot(Node):
    """Obeys velocities."""

    def __init__(self):
        super().__init__("robot")
        self.speeds = []
        self.create_subscription(Twist, "/cmd_vel", lambda m: self.speeds.append(m.linear.x), 100)


class Driver(Node):
    """Publishes velocities."""

    def __init__(self):
        super().__init__("driver")
        self.create_publisher(Twist, "/cmd_vel")


def test_messages_come_as_they_were_recorded(cli, log, listener, wait_until):
    messages = [("PLAIN", 0.0, PLAIN), ("/a", 0.05, ODOMETRY), ("/a", 0.06, b""), ("/b", 0.2, b"x")]
    ghost = ("/_lcmtools/node", 0.01, b"an announcement of a node that is gone")
    done = cli("bag", "play", log(messages[0], ghost, *messages[1:]))
    assert (done.code, done.out) == (0, "")
    taken = re.match(r"lcmtools bag play: 4 messages in (\d\.\d) s\n", done.err)
    assert taken
    assert float(taken[1]) >= 0.2
    wait_until(lambda: len(listener.received) >= 4)
    assert listener.received == [(channel, data) for channel, _, data in messages]


def test_what_is_in_use_is_not_played(cli, ride, listener, start_node):
    start_node(Robot)
    start_node(Driver)
    done = cli("bag", "play", ride)
    assert done.code == 1
    obeyed, published, end = done.err.splitlines()
    assert_says(obeyed, "lcmtools bag play: /robot (", "would obey /cmd_vel")
    assert_says(published, "lcmtools bag play: /driver (", "publishes /cmd_vel")
    assert_says(end, "lcmtools bag play: nothing is played; ", "--force plays anyway")
    assert listener.received == []
    typed = re.search("lcmtools (bag play .*) goes ahead", end)
    assert typed
    assert cli(*shlex.split(typed[1])).code == 0


@pytest.mark.parametrize(
    ("words", "topics"),
    [
        (["-x", "cmd_vel"], {"/odom"}),
        (["__ns:=/replay"], {"/replay/cmd_vel", "/replay/odom"}),
        (["/cmd_vel:=/old/cmd_vel"], {"/old/cmd_vel", "/odom"}),
        (["-t", "/odom", "--remap", "odom:=x"], {"/x"}),
    ],
)
def test_what_is_moved_or_left_out_is_played(  # noqa: PLR0913, PLR0917 - fixtures
    cli, ride, listener, start_node, wait_until, words, topics
):
    robot = start_node(Robot)
    done = cli("bag", "play", ride, "--rate", "0", *words)
    assert done.code == 0, done
    wait_until(lambda: len(listener.received) >= 5 * len(topics))
    assert {channel for channel, _ in listener.received} == topics
    assert robot.node.speeds == []


def test_a_forced_command_is_followed_by_zero(cli, ride, bus_url, start_node, wait_until):
    robot = start_node(Robot)
    done = cli("bag", "play", ride, "--force", "--rate", "10", env={"LCM_DEFAULT_URL": bus_url})
    assert done.code == 0, done
    said = done.err.splitlines()
    assert_says(said[0], "lcmtools bag play: /robot (", "would obey /cmd_vel")
    assert_says(said[1], "lcmtools bag play: over", "/cmd_vel", "linear.x 0.5", "zero was sent")
    wait_until(lambda: robot.node.speeds[-1:] == [0.0])
    assert robot.node.speeds[:5] == [0.5] * 5


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_no_command_without_a_word(cli, ride, bus_url, start_node, number):
    robot = start_node(Robot)
    words = ["bag", "play", ride, "--force", "--loop"]
    done = cli(
        *words,
        until=lambda _: len(robot.node.speeds) > 6,
        ends_by=number,
        env={"LCM_DEFAULT_URL": bus_url},
    )
    assert done.code == 128 + number
    assert_says(done.err, "ended", "/cmd_vel", "linear.x 0.5", "zero was sent")


def test_who_plays_announces_the_topics_and_is_told_of_others(
    cli, ride, bus_url, start_node, monkeypatch
):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    robot = start_node(Watcher)

    def is_warned(text):
        topic = robot.node.graph().topic("/odom")
        if topic.publishers and not robot.node.seen:
            robot.node.seen = topic.publishers[0][1].type
            start_node(Driver)
        return "/cmd_vel is published by /driver" in text

    done = cli("bag", "play", ride, "--loop", until=is_warned)
    assert robot.node.seen == "nav_msgs/Odometry"
    assert done.err.count("is published by /driver") == 1
    assert " while it is played" in done.err


class Watcher(Node):
    """Looks at the graph."""

    def __init__(self):
        super().__init__("watcher")
        self.seen = ""


class Sleeper(Node):
    """Is on simulated time."""

    def __init__(self):
        super().__init__("sleeper")
        self.times = []
        said = lambda _: self.times.append(self.get_clock().now())  # noqa: E731
        self.create_subscription(Odometry, "/odom", said, 100)


def test_nodes_on_simulated_time_have_the_time_of_the_log(cli, ride, bus_url, start_node):
    node = start_node(Sleeper, "_use_sim_time:=true").node
    done = cli("bag", "play", ride, "--clock", env={"LCM_DEFAULT_URL": bus_url})
    assert done.code == 0, done
    assert len(node.times) == 5
    assert all(START <= time < START + S for time in node.times[1:])


@pytest.mark.parametrize(("last", "wait"), [(1000, "16m "), (10 * 365 * 86400, "87")])
def test_a_long_wait_for_the_next_message_is_told_once(cli, log, bus_url, last, wait):
    path = log(*(("/odom", time, ODOMETRY) for time in (0, 0.1, last)))
    done = cli(
        *("bag", "play", path),
        env={"LCM_DEFAULT_URL": bus_url},
        until=lambda text: "is due in" in text,
    )
    assert done.code == 130
    assert done.err.count(f"the next message is due in {wait}") == 1
    assert "--end leaves it out" in done.err
    done = cli("bag", "play", path, "--end", "1s", env={"LCM_DEFAULT_URL": bus_url})
    assert done.code == 0
    assert "is due" not in done.err
    done = cli("bag", "play", path, "--max-gap", "2s", env={"LCM_DEFAULT_URL": bus_url})
    assert done.code == 0
    assert_says(done.err, f"skipped {wait}", "3 messages in 0.")


def test_playing_waits_for_a_subscriber_of_each_topic(cli, ride, bus_url, start_node):
    done = cli(
        *("bag", "play", ride, "-w", "-x", "/cmd_vel"),
        env={"LCM_DEFAULT_URL": bus_url},
        until=lambda text: "of /odom; plain LCM programs do not count" in text,
    )
    assert done.code == 130
    start_node(Sleeper)
    done = cli("bag", "play", ride, "-w", "-x", "/cmd_vel", env={"LCM_DEFAULT_URL": bus_url})
    assert done.code == 0, done


def test_lcms_own_programs_record_what_is_played_and_play_it(  # noqa: PLR0913, PLR0917 - fixtures
    cli, ride, tmp_path, bus_url, listener, lcm_program, start, wait_until
):
    path = tmp_path / "again.lcmlog"
    logger = start(lcm_program("lcm-logger"), "-q", "-l", bus_url, str(path))
    wait_until(path.exists)
    done = cli(
        *("bag", "play", ride, "-x", "/cmd_vel", "--loop"),
        until=lambda _: ODOMETRY in path.read_bytes(),
    )
    assert done.code == 130
    logger.send_signal(signal.SIGINT)
    logger.wait()
    recorded = [one for one in packets(path.read_bytes()) if one.channel == "/odom"]
    assert {one.payload for one in recorded} == {ODOMETRY}
    listener.received.clear()
    subprocess.run([lcm_program("lcm-logplayer"), "-l", bus_url, ride], check=True, timeout=40)
    wait_until(lambda: len(listener.received) >= 10)
    assert set(listener.received) == {("/cmd_vel", twist(0.5)), ("/odom", ODOMETRY)}


@pytest.fixture
def typist(lcmtools_path, bus_url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", bus_url)
    typists = []

    def sit_down(*words):
        typists.append(Typist(lcmtools_path, *words))
        return typists[-1]

    yield sit_down
    for one in typists:
        one.close()


def test_keys_at_a_terminal(log, start_node, typist, wait_until):
    robot = start_node(Robot).node
    path = log(*(("/cmd_vel", float(time), twist(time)) for time in range(1, 1000)))
    one = typist("bag", "play", path, "--force", "--pause")
    before = one.settings()
    one.wait_for("0.0 / 998.0 s  paused")
    one.type(".")
    one.wait_for("paused: the last command on /cmd_vel was linear.x 1; zero was sent after it")
    wait_until(lambda: robot.speeds[:2] == [1.0, 0.0])
    one.type("5")
    one.wait_for("499.0 / 998.0 s  paused")
    one.type(" \x1b[A")
    one.wait_for("/ 998.0 s  x2")
    wait_until(lambda: robot.speeds[-1] >= 500.0)
    one.type("q")
    assert one.end() == 0
    one.wait_for("ended: the last command on /cmd_vel was linear.x 5")
    assert one.settings() == before


def test_a_pause_needs_a_terminal(cli, ride):
    done = cli("bag", "play", ride, "--pause")
    assert done.code == 2
    assert_says(done.err, "lcmtools bag play: --pause needs a terminal", "leave it out\n")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--start", "1m"], "the start, 1m, is after the end of the log; the log is 0.4 s long"),
        (["-s", "0.31", "-e", "0.32"], "the log has no messages between these times"),
        (["-t", "/od"], "there is no topic /od in the log; did you mean /odom?"),
    ],
)
def test_nothing_of_the_log_is_meant(cli, ride, words, said):
    done = cli("bag", "play", ride, *words)
    assert done.code in (1, 2)
    assert said in done.err


@pytest.fixture
def map_log(tmp_path):
    """A log of 20 s whose node has latched /map at its start, and /odom."""
    path = tmp_path / "map.lcmlog"
    end = Endpoint("/map", Role.PUBLISHER, ("nav_msgs/Odometry",), latched=True)
    said = encode_announcement(Announcement(NodeInfo("/maps", "1", "ada", 1, endpoints=(end,))))
    with LogWriter(path) as writer:
        sender = writer.sender_number(Sender("127.0.0.1", 1), "/maps")
        writer.add_node(RecordedNode(START, sender, said))
        writer.add(Packet("/map", ODOMETRY, START), sender)
        for tenth in range(200):
            writer.add(Packet("/odom", ODOMETRY, START + tenth * S // 10), sender)
    return str(path)


class Viewer(Node):
    """Subscribes to a map."""

    def __init__(self):
        super().__init__("viewer")
        self.maps = []
        self.create_subscription(Odometry, "/map", self.maps.append, 10)


def test_a_late_subscriber_gets_what_was_latched(
    map_log, start, start_node, lcmtools_path, listener, wait_until
):
    start(lcmtools_path, "bag", "play", map_log, "-s", "5s")
    wait_until(lambda: sum(channel == "/odom" for channel, _ in listener.received) > 3)
    assert listener.received[0] == ("/map", ODOMETRY)
    late = start_node(Viewer)
    wait_until(lambda: late.node.maps)


@pytest.mark.parametrize("rate", ["1", "0"])
def test_nothing_overtakes_a_large_message(cli, log, listener, rate):
    sent = ["/image", *(f"/small{number}" for number in range(5))]
    payloads = [bytes(PACED_ABOVE_BYTES + 1), *(bytes(8) for _ in sent[1:])]
    messages = [(topic, 0.0, payload) for topic, payload in zip(sent, payloads, strict=True)]
    assert cli("bag", "play", log(*messages), "-q", "-r", rate).code == 0
    assert [channel for channel, _ in listener.received if channel in sent] == sent
