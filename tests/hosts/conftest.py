"""Two or three hosts, each in namespaces of its own, and what runs on them.

They are computers to all programs: nothing leaves them, and nothing of them is left.
"""

import importlib.util
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest


def _network():
    """network.py beside this file, which is in no package."""
    name = "lcmtools_tests_network"
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name("network.py"))
        assert spec is not None
        assert spec.loader is not None
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


@pytest.fixture
def network(start, lcmtools_process, tmp_path):
    """``network("ada", "bob")``: hosts of these names around a switch (network.py, Network)."""
    with ExitStack() as closing:

        def make(*names):
            made = _network().network(names, tmp_path, (start, lcmtools_process))
            return closing.enter_context(made)

        yield make


@pytest.fixture
def pair(network):
    """The hosts ada and bob."""
    return network("ada", "bob").hosts


@pytest.fixture(scope="module")
def module_pair(module_start, lcmtools_process, tmp_path_factory):
    """The hosts ada and bob, which the tests of a module share."""
    folder = tmp_path_factory.mktemp("hosts")
    with _network().network(("ada", "bob"), folder, (module_start, lcmtools_process)) as net:
        yield net.hosts


@pytest.fixture(scope="session")
def plain():
    """A plain LCM program: CHANNEL BYTES PERIOD; it sends messages of no known type."""
    return (
        "import lcm, sys, time\n"
        "bus = lcm.LCM()\n"
        "while True:\n"
        "    bus.publish(sys.argv[1], bytes(8) + bytes(int(sys.argv[2])))\n"
        "    print('sends', flush=True)\n"
        "    time.sleep(float(sys.argv[3]))\n"
    )
