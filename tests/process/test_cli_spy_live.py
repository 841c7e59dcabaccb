"""spy in a terminal: it starts, shows the bus, and gives the terminal back."""

import os
import pty
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from fcntl import ioctl

import lcm
import pytest
from fixtures.says import assert_line

from lcmtools.types.geometry_msgs import Point
from lcmtools.types.sensor_msgs import Image

LEFT = b"\x1b[?1049l"
"""The sequences that give the terminal back as it was."""
ESCAPE, ENTER = b"\x1b", b"\r"


class Terminal:
    """A terminal with a program in it, and a bus that somebody publishes on meanwhile."""

    def __init__(self, command, url, environment):
        self.screen, self._end = pty.openpty()
        self.resize(30, 120)
        self.before = termios.tcgetattr(self._end)
        self.written = bytearray()
        self.messages = {}
        self._bus = lcm.LCM(url) if url.startswith("udpm") else None
        # as some shells have it; the terminal's own size counts
        usual = {"LCM_DEFAULT_URL": url, "TERM": "xterm-256color", "COLUMNS": "77"}
        self.program = subprocess.Popen(
            ["setsid", "--ctty", *command],  # noqa: S607
            stdin=self._end,
            stdout=self._end,
            stderr=self._end,
            env={**os.environ, **usual, **environment},
        )

    def resize(self, rows, columns):
        """Make it another size."""
        ioctl(self._end, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def type(self, keys):
        """Press keys; what was written before is forgotten."""
        self.written.clear()
        os.write(self.screen, keys)

    def wait_for(self, *texts, timeout=40.0):
        """Publish, and read, until all the texts have been written."""
        deadline = time.monotonic() + timeout
        while not all(text.encode() in self.written for text in texts):
            self._publish_and_read()
            if time.monotonic() > deadline:
                pytest.fail(f"no {texts} in {self.written.decode(errors='replace')[-3000:]}")

    def wait(self, timeout=20.0):
        """The program's exit code; fails the test when it does not end in time."""
        deadline = time.monotonic() + timeout
        while self.program.poll() is None:
            self._publish_and_read()
            if time.monotonic() > deadline:
                pytest.fail("it does not end")
        self._publish_and_read()
        return self.program.returncode

    @property
    def is_given_back(self):
        """Return whether the terminal is as it was."""
        return LEFT in self.written and termios.tcgetattr(self._end) == self.before

    def close_screen(self):
        """Close the terminal's window."""
        os.close(self.screen)
        os.close(self._end)
        self.screen = -1

    def close(self):
        """End it all."""
        self.program.kill()
        self.program.wait()
        if self.screen >= 0:
            self.close_screen()

    def _publish_and_read(self):
        for channel, payload in self.messages.items():
            assert self._bus is not None
            self._bus.publish(channel, payload)
        while select.select([self.screen], [], [], 0.02)[0]:
            self.written.extend(os.read(self.screen, 65536))


@pytest.fixture
def spy(lcmtools_path, bus_url):
    """``spy("--sort", "rate", url=..., NO_COLOR="1")``: the live view in a terminal."""
    terminals = []

    def run(*arguments, url=bus_url, **environment):
        command = [lcmtools_path, "spy", *arguments]
        terminals.append(Terminal(command, url, environment))
        return terminals[-1]

    yield run
    for terminal in terminals:
        terminal.close()


def point():
    message = Point()
    message.x = 1234.5
    return message.encode()


@pytest.mark.parametrize(
    ("ending", "code"),
    [(b"q", 0), (b"\x03", 130), (signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)],
)
def test_it_shows_the_bus_and_gives_the_terminal_back(spy, ending, code):
    terminal = spy()
    terminal.messages["POSE"] = point()
    terminal.wait_for("\x1b[?1049h", "CHANNEL", "POSE", "geometry_msgs/Vector3 +1")
    if isinstance(ending, bytes):
        terminal.type(ending)
    else:
        terminal.written.clear()
        terminal.program.send_signal(ending)
    assert terminal.wait() == code
    assert terminal.is_given_back
    assert b"Traceback" not in terminal.written


def test_it_ends_when_its_terminal_is_closed(spy):
    terminal = spy()
    terminal.messages["POSE"] = point()
    terminal.wait_for("CHANNEL", "POSE")
    terminal.close_screen()
    assert terminal.program.wait(40) == 129


def test_enter_decodes_whole_messages_however_large(spy):
    terminal = spy()
    image = Image()
    image.encoding = "what a camera sends"
    image.data = bytes(300_000)
    image.data_length = len(image.data)
    terminal.messages["IMAGE"] = image.encode()
    terminal.wait_for("IMAGE", "sensor_msgs/Image")
    terminal.type(ENTER)
    terminal.wait_for("what a camera sends", "uint8[300000] 00 00")
    terminal.type(ESCAPE)
    terminal.wait_for("CHANNEL")
    terminal.type(b"q")
    assert terminal.wait() == 0


def test_the_table_is_drawn_anew_in_another_size(spy):
    terminal = spy()
    terminal.messages["POSE"] = point()
    terminal.wait_for("POSE", "LISTENERS")
    terminal.written.clear()
    terminal.resize(20, 60)
    terminal.program.send_signal(signal.SIGWINCH)
    terminal.wait_for("\x1b[20;1H", "f1")  # the keys are on the last line now
    terminal.type(b"q")
    assert terminal.wait() == 0


def test_no_color_is_honoured(spy):
    colored, plain = spy(), spy(NO_COLOR="1")
    for terminal in (colored, plain):
        terminal.messages["POSE"] = point()
        terminal.wait_for("CHANNEL", "POSE")
    for color in (b"32m", b"42m", b"46m", b"[38;"):
        assert color not in plain.written
    assert b"42m" in colored.written


def test_a_server_that_goes_away_is_a_line_on_the_screen(spy, tcpq_server):
    sender = lcm.LCM(tcpq_server.url)
    terminal = spy(url=tcpq_server.url)
    terminal.wait_for("CHANNEL")
    deadline = time.monotonic() + 40
    while b"POSE" not in terminal.written and time.monotonic() < deadline:
        sender.publish("POSE", point())
        terminal._publish_and_read()
    terminal.wait_for("POSE")
    terminal.type(ENTER)
    deadline = time.monotonic() + 40
    while b"1234.5" not in terminal.written and time.monotonic() < deadline:
        sender.publish("POSE", point())
        terminal._publish_and_read()
    terminal.wait_for("1234.5")  # whole messages come by the one connection
    terminal.type(ESCAPE)
    terminal.wait_for("CHANNEL")
    terminal.written.clear()
    tcpq_server.close()
    terminal.wait_for("is lost; it is tried again until it is back")
    terminal.written.clear()
    tcpq_server.reopen()
    sender = lcm.LCM(tcpq_server.url)
    deadline = time.monotonic() + 40
    while b"NEW" not in terminal.written and time.monotonic() < deadline:
        sender.publish("NEW", point())
        terminal._publish_and_read()
    terminal.wait_for("NEW")
    terminal.type(b"q")
    assert terminal.wait() == 0


def test_a_bus_that_cannot_be_reached_is_told_before_the_screen_is_taken(spy, tcpq_server):
    tcpq_server.close()
    terminal = spy(url=tcpq_server.url)
    assert terminal.wait() == 1
    assert b"lcmtools spy:" in terminal.written
    assert b"no LCM server" in terminal.written
    assert b"\x1b[?1049h" not in terminal.written


def test_without_textual_one_line_says_what_to_install(bus_url):
    script = (
        "import sys\n"
        "sys.modules['textual'] = None\n"
        "from lcmtools.cli.main import main\n"
        "sys.exit(main(['spy']))\n"
    )
    terminal = Terminal([sys.executable, "-c", script], bus_url, {})
    try:
        assert terminal.wait() == 3
        text = " ".join(terminal.written.decode().split())
        assert "type: pip install 'lcmtools-robotics[tui]' (--once does without)" in text
    finally:
        terminal.close()


def test_where_the_output_is_no_terminal_it_says_what_to_type(bus_url, cli):
    done = cli("spy", env={"LCM_DEFAULT_URL": bus_url})
    assert (done.code, done.out) == (2, "")
    assert_line(done.err, "lcmtools spy: ", "terminal; --once")


def test_where_the_terminal_cannot_move_the_cursor_too(spy):
    terminal = spy(TERM="dumb")
    assert terminal.wait() == 2
    assert terminal.written == b"lcmtools spy: spy needs a terminal; --once prints the table\r\n"
