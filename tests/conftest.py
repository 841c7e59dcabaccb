"""Fixtures of all tests: a private bus, a network of one's own, processes that surely end.

Nothing here waits for luck: every wait has a condition and a deadline.
"""

import functools
import itertools
import os
import signal
import subprocess
import sys
import sysconfig
import time
from contextlib import ExitStack, suppress
from itertools import groupby
from pathlib import Path

import hypothesis
import pytest
from fixtures import networks
from fixtures.command import call
from fixtures.nodes import LiveNode
from fixtures.programs import Program, Stopwatch

from lcmtools.bus.multicast import check_multicast, check_route
from lcmtools.bus.url import parse_url
from lcmtools.errors import BusError

COMMAND = str(Path(sysconfig.get_path("scripts")) / "lcmtools")
_INHERITED = (
    *("LCM_DEFAULT_URL", "LCM_DBG", "NO_COLOR", "FORCE_COLOR", "CLICOLOR_FORCE"),
    *(
        f"LCMTOOLS_{name}"
        for name in (
            "DOMAIN",
            "NAMESPACE",
            "COLOR",
            "TIMEOUT",
            "DEBUG",
            "TYPE_PATH",
            "PACKAGE_PATH",
        )
    ),
)


_SECONDS = {
    "labs": 15,
    "docs": 15,
    "faults": 5,
    "endure": 10,
    "hosts": 4,
    "gui": 3,
    "process": 1,
    "physics": 0.3,
}
"""About how long a test takes, by its folder; of others it is no matter."""
_ALONE = {"labs", "docs", "faults"}  # tests there have nothing in common with their neighbours
_BUSES = {"bus_url", "module_bus_url", "free_port"}
_OWN_NETWORKS = {"bare_network", "private_network", "network", "pair", "module_pair"}
"""Fixtures that make networks of a test's own, as only root can."""


def pytest_configure(config):
    """Let a test's processes begin as they would in a terminal, however pytest was started.

    A shell lets what runs behind & ignore Ctrl-C, and nohup what it runs the end of the terminal:
    children inherit that. They inherit too that Python keeps nothing of what it compiles, and then
    each of thousands compiles the same again; or that it buffers nothing, as it does for nobody.
    No test opens a window on the developer's screen.
    """
    for name in ("PYTHONDONTWRITEBYTECODE", "PYTHONUNBUFFERED", "DISPLAY", "WAYLAND_DISPLAY"):
        os.environ.pop(name, None)
    for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):  # of the make that runs the tests
        os.environ.pop(name, None)
    os.environ["BROWSER"] = "true"  # for systems that always have a display
    examples = max(1, int(30 * float(os.environ.get("LCMTOOLS_FUZZ", "1"))))
    # how long an example takes is no matter
    hypothesis.settings.register_profile("short", deadline=None, max_examples=examples)
    hypothesis.settings.load_profile("short")
    if config.getoption("numprocesses", None):
        return  # the workers do the rest, who start the processes
    for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM):
        if signal.getsignal(number) is signal.SIG_IGN:
            own = signal.default_int_handler if number == signal.SIGINT else _go_on
            signal.signal(number, own)


def _go_on(number, frame):
    """Ignore a signal in such a way that no child inherits it."""


@pytest.hookimpl(tryfirst=True)  # before -m chooses by the marks
def pytest_collection_modifyitems(items):
    """Order tests for workers that each begin with an equal part (pytest --dist worksteal).

    In every part the long ones come first, so that no worker is alone with them in the end. Files
    stay together, for their tests may share what they start.
    """
    for item in items:
        if _OWN_NETWORKS & set(getattr(item, "fixturenames", ())):
            item.add_marker("root")
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    parts = [[] for _ in range(workers)]
    seconds = [0.0] * workers
    items.sort(key=_seconds, reverse=True)
    short = [item for item in items if not _seconds(item)]
    for _, group in groupby(items[: len(items) - len(short)], _shares_with):
        together = list(group)
        least = seconds.index(min(seconds))
        parts[least] += together
        seconds[least] += sum(map(_seconds, together))
    for number, part in enumerate(parts):
        size = len(items) * (number + 1) // workers - len(items) * number // workers
        room = max(0, size - len(part))
        part.extend(short[:room])
        del short[:room]
    items[:] = [item for part in (*parts, short) for item in part]


def pytest_runtest_setup(item):
    """Skip what only root or multicast can do, in one sentence for all."""
    if item.get_closest_marker("root") and os.getuid() != 0:
        pytest.skip("only root can do that; .ci/run as root does it")
    names = set(getattr(item, "fixturenames", ()))
    if names & _BUSES and not names & _OWN_NETWORKS and _no_multicast():
        pytest.skip(_no_multicast())


@functools.cache
def _no_multicast():
    """Return what the product says where multicast does not work, else ""."""
    url = parse_url("udpm://239.255.76.67:7667?ttl=0")
    try:
        check_route(url)  # plain LCM programs need one, although lcmtools does not
        check_multicast(url)
    except BusError as error:
        return str(error)
    return ""


def _folder(item):
    return Path(os.path.relpath(item.path, Path(__file__).parent)).parts[0]


def _seconds(item):
    return _SECONDS.get(_folder(item), 0)


def _shares_with(item):
    return item.nodeid if _folder(item) in _ALONE else str(item.path)


_FOLDERS = itertools.count()


@pytest.fixture(scope="session")
def _own_folders(tmp_path_factory):
    return tmp_path_factory.mktemp("own")


@pytest.fixture(autouse=True)
def _clean_environment(monkeypatch, _own_folders):
    """No bus and no settings of the developer's own, and node records in the test's folder."""
    for name in _INHERITED:
        monkeypatch.delenv(name, raising=False)
    own = _own_folders / str(next(_FOLDERS))  # mktemp looks at all folders each time
    for variable in ("XDG_RUNTIME_DIR", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        folder = own / variable
        folder.mkdir(0o700, parents=True)
        monkeypatch.setenv(variable, str(folder))


@pytest.fixture
def free_port():
    """Gives UDP ports that no other test, worker or program of this computer uses."""
    held = []

    def take():
        held.append(networks.reserve_port())
        return int(held[-1].getsockname()[1])

    yield take
    for lock in held:
        lock.close()


@pytest.fixture
def bus_url(free_port):
    """A multicast bus that belongs to this test alone and stays on this computer."""
    return f"udpm://239.255.76.67:{free_port()}?ttl=0"


@pytest.fixture(scope="session")
def stopwatch():
    """``stopwatch(pid)``: see Stopwatch."""
    return Stopwatch


@pytest.fixture
def wait_until():
    """``wait_until(condition, timeout=40.0)``: polls; fails the test at the deadline."""

    def wait(condition, timeout=40.0):
        deadline = time.monotonic() + timeout
        while not condition():
            if time.monotonic() > deadline:
                pytest.fail(f"not within {timeout} s: {condition}")
            time.sleep(0.002)

    return wait


@pytest.fixture
def start(tmp_path):
    """``start(*command, **environment)``: a process that is ended with the test."""
    programs = []

    def run(*command, popen=subprocess.Popen, **environment):
        programs.append(Program(command, tmp_path, environment, popen))
        return programs[-1]

    yield run
    for program in programs:
        program.end()


@pytest.fixture
def start_python(start, tmp_path):
    """``start_python(source, *arguments, **environment)``: the same for a script's text."""

    def run(source, *arguments, **environment):
        script = tmp_path / f"script_{len(list(tmp_path.glob('script_*')))}.py"
        script.write_text(source)
        return start(sys.executable, str(script), *arguments, **environment)

    return run


@pytest.fixture
def bare_network():
    """A network of the test's own in which nothing works yet: no route, loopback down.

    The test's thread is in it, with all processes and threads that it starts.
    """
    with networks.own_network():
        yield


@pytest.fixture
def private_network():
    """A network of the test's own where multicast works: for floods and malformed datagrams."""
    with networks.own_network():
        networks.let_multicast_work()
        yield


@pytest.fixture
def quiet_network():
    """The same where it is permitted, else the computer's: for what looks at all that goes on."""
    with ExitStack() as stack:
        with suppress(pytest.skip.Exception):
            stack.enter_context(networks.own_network())
            networks.let_multicast_work()
        yield


@pytest.fixture
def ip():
    """``ip("route", "del", ...)``: changes the network of ``private_network``."""
    return networks.ip


@pytest.fixture(scope="session")
def cli():
    """``cli("list", "-v", input="", env={}) -> Result``: runs a command in the test's process."""
    return call


@pytest.fixture
def start_node(bus_url):
    """``start_node(Talker, "__ns:=/a", url=None)``: a node that runs in the test's process.

    It is on ``bus_url``, unless another one is named, and leaves with the test.
    """
    yield from _node_starter(bus_url)


@pytest.fixture(scope="module")
def module_start_node(module_bus_url, module_runtime):
    """``start_node`` for nodes that the tests of a module share, on the module's bus."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", module_runtime)
        yield from _node_starter(module_bus_url)


def _node_starter(usual_url):
    nodes = []

    def run(make, *words, url=None):
        nodes.append(LiveNode(make, url or usual_url, *words))
        return nodes[-1]

    yield run
    for node in nodes:
        node.end()


@pytest.fixture(scope="session")
def lcmtools_process():
    """``lcmtools_process("list", "-v", **environment)``: the installed command, in a process."""

    def run(*arguments, stdin="", timeout=40.0, **environment):
        return subprocess.run(
            [COMMAND, *arguments],
            input=stdin,
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=timeout,
            check=False,
        )

    return run


@pytest.fixture(scope="session")
def lcmtools_path():
    """The installed command, for ``start``."""
    return COMMAND


@pytest.fixture(scope="session")
def lcm_program():
    """``lcm_program("lcm-sink")``: the path of a program that the lcm package brings.

    The program itself, and not the wrapper on the PATH: a signal to that ends the wrapper only.
    """

    def find(name):
        path = Path(sysconfig.get_paths()["purelib"]) / "bin" / name
        assert path.exists(), path
        return str(path)

    return find


@pytest.fixture(scope="module")
def module_bus_url():
    """A bus that the tests of a module share."""
    with networks.reserve_port() as lock:
        yield f"udpm://239.255.76.67:{lock.getsockname()[1]}?ttl=0"


@pytest.fixture(scope="module")
def module_runtime(tmp_path_factory):
    """The folder of the records of a module's nodes, as users have one for all their programs."""
    return str(tmp_path_factory.mktemp("runtime"))


@pytest.fixture(scope="module")
def module_start(module_bus_url, module_runtime, tmp_path_factory):
    """``start`` for processes that the tests of a module share, on the module's bus."""
    programs = []
    shared = {
        "LCM_DEFAULT_URL": module_bus_url,
        "XDG_RUNTIME_DIR": module_runtime,
        "LCMTOOLS_NAMESPACE": "",
        "XDG_CONFIG_HOME": str(tmp_path_factory.getbasetemp()),
        "XDG_STATE_HOME": str(tmp_path_factory.getbasetemp()),
    }

    def run(*command, popen=subprocess.Popen, **environment):
        directory = tmp_path_factory.mktemp("programs")
        programs.append(Program(command, directory, {**shared, **environment}, popen))
        return programs[-1]

    yield run
    for program in programs:
        program.end()


@pytest.fixture
def use_module_bus(module_bus_url, module_runtime, monkeypatch):
    """Let the commands of a test look at the module's bus and know of its nodes."""
    monkeypatch.setenv("LCM_DEFAULT_URL", module_bus_url)
    monkeypatch.setenv("XDG_RUNTIME_DIR", module_runtime)


def pytest_terminal_summary(terminalreporter):
    """Sum the faults suite up (tests/faults), whichever workers ran it."""
    told = [
        value
        for reports in terminalreporter.stats.values()
        for report in reports
        if getattr(report, "when", "") == "teardown"
        for name, value in report.user_properties
        if name == "faults"
    ]
    if told:
        planted, found, looks, alarms = (sum(column) for column in zip(*told, strict=True))
        terminalreporter.write_line(
            f"faults: found {found} of {planted} planted, {alarms} false alarms in"
            f" {looks} healthy looks"
        )
