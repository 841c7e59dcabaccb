"""Computers made of namespaces: each has its own network, name and processes.

They stand around a switch, which has a namespace too and can lose frames, or be unplugged. All of
a computer's processes die with the keeper of its namespaces, and that one with the tests' process.
"""

import array
import ctypes
import fcntl
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

import pytest

GROUP, PORT = "239.255.76.67", 7667
URL = f"udpm://{GROUP}:{PORT}"
_CLONE_FS = 0x200
_NAMESPACES = ("net", "uts", "pid_for_children", "mnt")
_KEEPER = [
    *("setpriv", "--pdeathsig", "KILL", "unshare", "--kill-child"),  # with the tests, however
    *("--net", "--uts", "--mount", "--pid", "--fork", "--mount-proc"),
]
_WAKE = (
    "echo {name} >/proc/sys/kernel/hostname && ip link set lo up"
    " && mount -t tmpfs tmpfs /dev/shm"  # Zenoh would pass messages through shared memory
    " && (echo cubic >/proc/sys/net/ipv4/tcp_congestion_control || true)"  # Linux's usual one
    " && echo up && exec sleep inf"
)
_TOOLS = ("setpriv", "unshare", "nsenter", "ip")
_LOSSY = Path(__file__).with_name("lossy.py")
_LINE = Path(__file__).with_name("line.py")
_SIOCETHTOOL = 0x8946
_OFFLOADS = (0x17, 0x1F, 0x21, 0x24)  # ETHTOOL_STXCSUM, _STSO, _SUFO, _SGSO


class Computer:
    """The namespaces of one computer, and a thread of this process that is in them.

    Args:
        name: What ``hostname`` prints there.
        start: The fixture ``start`` or ``module_start``, which also ends what it has started.

    Attributes:
        pid: A process that is in its network, in the numbers of the tests' process.
    """

    def __init__(self, name, start):
        self.name = name
        self._start = start
        keeper = start(*_KEEPER, "sh", "-c", _WAKE.format(name=name))
        keeper.wait_for("up")
        self.pid = keeper.pid
        self._thread = ThreadPoolExecutor(1, thread_name_prefix=name)
        self.call(_enter, self.pid)

    def start(self, *command, **environment):
        """A program there (``Program``), which is ended with the test."""
        return self._start(*command, popen=self._popen, **environment)

    def call(self, function, *arguments, **named):
        """The result of a function there; the processes that it starts stay there."""
        return self._thread.submit(function, *arguments, **named).result()

    def ip(self, *arguments):
        """Change its network: ``ip("link", "set", "eth0", "down")``."""
        self.call(subprocess.run, [shutil.which("ip") or "ip", *arguments], check=True)

    def close(self):
        """Leave its namespaces."""
        self._thread.shutdown()

    def _popen(self, *arguments, **named):
        return self.call(subprocess.Popen, *arguments, **named)


class Host(Computer):
    """A computer on which programs of LCM run.

    Args:
        name: What it is called.
        address: Its address in the network.
        folder: Where its user's files are; no other host's are there.
        runs: The fixtures ``start`` (or ``module_start``) and ``lcmtools``.
    """

    def __init__(self, name, address, folder, runs):
        start, self._lcmtools = runs
        super().__init__(name, start)
        self.address = address
        self.environment = {
            "LCM_DEFAULT_URL": f"{URL}?ttl=1",
            "HOME": str(folder),
            "XDG_CACHE_HOME": str(folder / "cache"),
            "XDG_CONFIG_HOME": str(folder / "config"),
            "XDG_RUNTIME_DIR": str(folder / "run"),
        }
        (folder / "run").mkdir(parents=True)

    def start(self, *command, **environment):
        """A program there (``Program``), which is ended with the test."""
        return super().start(*command, **{**self.environment, **environment})

    def python(self, source, *arguments, **environment):
        """The same for a script's text."""
        return self.start(sys.executable, "-c", source, *arguments, **environment)

    def lcmtools(self, *arguments, **named):
        """Run the command there to its end."""
        done = self.call(self._lcmtools, *arguments, **{**self.environment, **named})
        return done

    def out(self, *arguments, **named):
        """The output of the command there; it has to succeed."""
        done = self.lcmtools(*arguments, **named)
        assert done.returncode == 0, (done.stdout, done.stderr)
        return done.stdout

    def next_pid(self, pid):
        """Let the next process get this number there."""
        write = f"echo {pid - 1} >/proc/sys/kernel/ns_last_pid"
        self.call(subprocess.run, ["sh", "-c", write], check=True)

    def ports(self, first, last):
        """From which range programs get the ports that they send from."""
        path = Path("/proc/sys/net/ipv4/ip_local_port_range")
        self.call(path.write_text, f"{first} {last}")


class Network:
    """Hosts around a switch, which is the network ``10.76.0.0/24``.

    Args:
        hosts: At most one for each port of the switch.
        switch: The computer that the switch is.
    """

    def __init__(self, hosts, switch):
        self.hosts = hosts
        self._switch = switch
        self._lossy = None
        switch.ip("link", "add", "bridge", "type", "bridge", "mcast_snooping", "0")
        switch.ip("link", "set", "bridge", "up")
        for host in hosts:
            self.connect(host, "eth0", host.address)
            host.ip("route", "add", "224.0.0.0/4", "dev", "eth0")

    def connect(self, host, interface, address):
        """Lead a cable from one more interface of a host to the switch."""
        port = _port(host, interface)
        peer = ("peer", "name", interface, "netns", str(host.pid))
        command = ["nsenter", f"--net=/proc/{self._switch.pid}/ns/net", "ip", "link", "add", port]
        subprocess.run([*command, "type", "veth", *peer], check=True)
        self._switch.ip("link", "set", port, "master", "bridge", "up")
        host.ip("address", "add", f"{address}/24", "dev", interface)
        host.ip("link", "set", interface, "up")

    def unplug(self, host):
        """Cut a host off; it notices no more than that of a pulled cable."""
        self._switch.ip("link", "set", _port(host), "down")

    def plug(self, host):
        """Connect it again."""
        self._switch.ip("link", "set", _port(host), "up")

    def lose(self, every, of=None):
        """Lose one in so many messages of each sender on the way between the first two hosts.

        Of both, or of one host only.
        """
        ports = [_port(host) for host in self.hosts[:2]]
        only = [_port(of)] if of else []
        for port in ports:
            self._switch.ip("link", "set", port, "nomaster")
        self._lossy = self._switch.start(sys.executable, str(_LOSSY), *ports, str(every), *only)
        self._lossy.wait_for("forwards")

    def stretch(self, host, delay_ms, every, rate):
        """Let a host's cable be a long line (line.py), whose program is returned."""
        port = _port(host)
        host.call(_without_offload, "eth0")
        self._switch.call(_without_offload, port)
        self._switch.ip("link", "set", port, "nomaster")
        self._switch.ip("link", "add", "line0", "type", "veth", "peer", "name", "line1")
        for end in ("line0", "line1"):
            self._switch.call(_without_offload, end)
            self._switch.ip("link", "set", end, "up")
        self._switch.ip("link", "set", "line1", "master", "bridge")
        settings = map(str, (delay_ms, every, rate))
        line = self._switch.start(sys.executable, str(_LINE), port, "line0", *settings)
        line.wait_for("forwards")
        return line

    def mend(self):
        """Lose nothing any more."""
        if self._lossy:
            self._lossy.send_signal(signal.SIGKILL)
            self._lossy.wait()
            self._lossy = None
            for host in self.hosts[:2]:
                self._switch.ip("link", "set", _port(host), "master", "bridge")


@contextmanager
def network(names, folder, runs):
    """Hosts of these names, 10.76.0.1 and so on, joined by a switch; all end with the block."""
    _check_permission()
    with ExitStack() as closing:
        hosts = []
        for number, name in enumerate(names, 1):
            own = folder / f"{number}-{name}"
            hosts.append(Host(name, f"10.76.0.{number}", own, runs))
            closing.callback(hosts[-1].close)
        switch = Computer("switch", runs[0])
        closing.callback(switch.close)
        yield Network(hosts, switch)


def _check_permission():
    """Skip the test, saying why, where there can be no such hosts."""
    if missing := [tool for tool in _TOOLS if shutil.which(tool) is None]:
        pytest.skip(f"hosts are made with {' and '.join(missing)}, which is missing here")
    pair = "ip link add one type veth peer name two && ip link add three type bridge"
    done = subprocess.run([*_KEEPER, "sh", "-c", pair], check=False, capture_output=True, text=True)
    if done.returncode:
        reason = done.stderr.strip()
        pytest.skip(f"hosts of namespaces are not possible here ({reason}); run the tests as root")


def _port(host, interface="eth0"):
    """The name of the switch's end of a cable: names of interfaces have 15 characters at most."""
    number = host.address.rpartition(".")[2]
    return f"port{number}{re.sub('[^0-9]', '-', interface)[-2:]}"


def _without_offload(interface):
    """Let an interface send frames as they are on a cable: small, and with checksums."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        for command in _OFFLOADS:
            value = array.array("I", (command, 0))
            request = struct.pack("16sP", interface.encode(), value.buffer_info()[0])
            with suppress(OSError):  # it has no such feature
                fcntl.ioctl(control, _SIOCETHTOOL, request)


def _enter(pid):
    """Take this thread into the namespaces of a process."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(_CLONE_FS) != 0:  # else the other threads would have to come along
        raise OSError(ctypes.get_errno(), "unshare")
    files = [os.open(f"/proc/{pid}/ns/{kind}", os.O_RDONLY) for kind in _NAMESPACES]
    try:
        for file in files:
            if libc.setns(file, 0) != 0:
                raise OSError(ctypes.get_errno(), "setns")
    finally:
        for file in files:
            os.close(file)
