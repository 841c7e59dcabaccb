"""The state of this computer that affects a bus, read from /proc and /sys if these exist.

Belongs here: everything that ``wtf`` reads besides the bus, and the messages that it sends to
itself, to test whether they arrive. Programs on the bus receive only LCM's usual self test: the
large message goes to a free port, with ttl 0. Must not judge.
"""

import contextlib
import errno
import fcntl
import os
import select
import shutil
import socket
import struct
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lcmtools.bus.multicast import (
    check_multicast,
    check_route,
    check_sending,
    receiving_socket,
    sending_socket,
)
from lcmtools.bus.network_watch import route_interface
from lcmtools.bus.processes import PROC, network_counter
from lcmtools.bus.sockets import joined, sockets_are_known
from lcmtools.bus.url import BusUrl, choose_url, misread_options
from lcmtools.doctor.evidence import Host
from lcmtools.errors import BusError, LcmtoolsError
from lcmtools.wire.datagram import fragments

if TYPE_CHECKING:
    from lcmtools.doctor.firewall import Traffic

_NET = Path("/sys/class/net")
_UP, _RUNNING, _MULTICAST = 0x1, 0x40, 0x1000  # linux/if.h
_WORKS = _UP | _RUNNING | _MULTICAST
_GET_FLAGS = 0x8913  # linux/sockios.h; /sys may show another network's interfaces
_TYPE_PACKAGES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs")
_UFW = Path("/etc/ufw/ufw.conf")
_FIREWALLD = Path("/run/firewalld.pid")
_READERS = {"nftables": ("nft", "list", "ruleset"), "iptables": ("iptables-save",)}
_TIMEOUT = 2.0  # [s] for a command
LARGE_BYTES = 300_000  # the size of the large message: five datagrams, as an image
_CHANNEL = "/_lcmtools/self_test"
_ARRIVAL_TIME = 0.5  # [s] for one datagram, which takes well under a millisecond
_LARGEST_DATAGRAM = 65_535  # bytes


def host(url: BusUrl, environment: Mapping[str, str]) -> Host:
    """Return the state of this computer that affects a bus."""
    interface = route_interface(url.host) if url.is_multicast else ""
    folder = _NET / interface if interface else Path("/nonexistent")
    flags = _flags(interface or "lo") if url.is_multicast else _WORKS  # where a route would lead
    filters = PROC / "sys/net/ipv4/conf"
    return Host(
        uid=os.getuid(),
        interface=interface,
        is_up=bool(flags & _UP),
        can_multicast=bool(flags & _MULTICAST) or not interface,
        has_link=bool(flags & _RUNNING) or not interface,
        joined=joined(url.host) if url.is_multicast else (),
        rp_filter=max(_number(filters / one / "rp_filter") for one in ("all", interface or "all")),
        speed_mbit=max(0, _number(folder / "speed")),
        is_wireless=(folder / "wireless").exists(),
        most_receive_buffer=_number(PROC / "sys/net/core/rmem_max"),
        container=_container(),
        environment=(*_environment(environment), *misread_options(url)),
        has_sockets=sockets_are_known(),
        **(_network(url, interface) if url.is_multicast else {}),
    )


def _network(url: BusUrl, interface: str) -> dict[str, Any]:
    """Return the state that affects messages to other computers, and the self test's result."""
    known: dict[str, Any] = {"large_bytes": LARGE_BYTES, "large_problem": large_problem(url)}
    if url.ttl:
        from lcmtools.doctor.firewall import Traffic  # a local bus needs no rules

        folder = _NET / interface
        known["firewall"], known["firewall_chain"], known["firewall_unknown"] = firewall(
            Traffic(url.host, url.port, interface)
        )
        known["send_problem"], known["send_remedy"] = send_problem(url)
        known["others"] = tuple(sorted(_routed_interfaces() - {interface, "lo"}))
        known["is_virtual"] = _number(folder / "iflink") != _number(folder / "ifindex")
        known["bridge"] = silent_bridge(interface)
    return known


def silent_bridge(interface: str) -> str:
    """Return an interface's bridge if it snoops IGMP without a querier; else ""."""
    folder = _NET / interface
    if not interface or not folder.exists():
        return ""
    bridge = folder if (folder / "bridge").exists() else (folder / "master").resolve()
    settings = bridge / "bridge"
    snoops = _number(settings / "multicast_snooping") == 1
    return bridge.name if snoops and not _number(settings / "multicast_querier") else ""


def _flags(interface: str) -> int:
    """Return an interface's flags; those of a working one if unknown."""
    if not PROC.joinpath("net/route").exists():
        return _WORKS
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        request = struct.pack("16s16x", interface.encode())
        return int(struct.unpack_from("=16xH", fcntl.ioctl(asking, _GET_FLAGS, request))[0])
    return _WORKS


def _routed_interfaces() -> set[str]:
    rows = text_of(PROC / "net/route").splitlines()[1:]
    return {columns[0] for row in rows if (columns := row.split())}


def reassembly_failures() -> int:
    """Return the number of IP datagrams that lost fragments, since the system started."""
    return network_counter("snmp", "Ip:", "ReasmFails")


def rp_filter_drops() -> int:
    """Return the number of IP datagrams that rp_filter dropped, since the system started."""
    return network_counter("netstat", "TcpExt:", "IPReversePathFilter")


def _container() -> str:
    if "microsoft" in text_of(PROC / "version").lower():
        return "WSL"
    files = (Path("/.dockerenv"), Path("/run/.containerenv"))
    return "container" if any(file.exists() for file in files) else ""


def _environment(environment: Mapping[str, str]) -> Iterable[str]:
    for name in ("PYTHONPATH", "LCMTOOLS_TYPE_PATH"):
        for part in environment.get(name, "").split(os.pathsep):
            if part and not os.access(part, os.R_OK):  # never raises, as Path.exists may
                why = "cannot be read" if _is_hidden(part) else "does not exist"
                yield f"{name} has {part}, which {why}"
    yield from _found_twice(environment)
    spec = _spec("lcm")
    folders = spec.submodule_search_locations if spec else None
    if spec is None:
        yield "the Python package lcm is missing: nodes cannot run"
    elif not any(list(Path(folder).glob("_lcm.*")) for folder in folders or ()):
        yield f"'import lcm' finds {spec.origin}, which may not be LCM's package"
    url, domain = environment.get("LCM_DEFAULT_URL"), environment.get("LCMTOOLS_DOMAIN")
    try:
        chosen, _ = choose_url("", "", environment)
        if url and domain and choose_url("", domain, {})[0].file_name != chosen.file_name:
            yield f"LCMTOOLS_DOMAIN={domain} has no effect beside LCM_DEFAULT_URL={url}"
    except LcmtoolsError as error:
        yield str(error)


def _spec(package: str) -> ModuleSpec | None:
    """Return the place of a package; None if there is none, or if it cannot be looked for."""
    with contextlib.suppress(OSError):
        return find_spec(package)
    return None


def _is_hidden(path: str) -> bool:
    """Return whether a folder above a path keeps this user from looking whether it exists."""
    try:
        os.stat(path)  # noqa: PTH116
    except OSError as error:
        return error.errno not in (errno.ENOENT, errno.ENOTDIR)
    return True


def _found_twice(environment: Mapping[str, str]) -> Iterable[str]:
    """Yield packages of types in several folders, for example those of ROS and of lcm-gen."""
    folders = [*environment.get("PYTHONPATH", "").split(os.pathsep), *sys.path]
    for name in _TYPE_PACKAGES:
        named = (os.path.join(f, name) for f in folders if f)  # noqa: PTH118 - these never raise
        places = {os.path.realpath(one): None for one in named if os.path.isdir(one)}  # noqa: PTH112
        if len(places) > 1:
            yield f"Python finds {name} in {' and in '.join(places)}; the first counts"


def firewall(traffic: "Traffic") -> tuple[str, str, str]:
    """Return a firewall that may drop a bus's datagrams, its chain, and why that is unknown.

    All are empty if there is none. The chain is known if the rules were readable.
    """
    from lcmtools.doctor.firewall import refusing_chain

    if "ENABLED=yes" in text_of(_UFW):
        return "ufw", "", ""
    if _FIREWALLD.exists():
        return "firewalld", "", ""
    unknown = ""
    readers = {name: command for name, command in _READERS.items() if shutil.which(command[0])}
    if not Path("/proc").exists():
        unknown = "its rules are not known on this system"
    elif os.getuid() != 0:
        unknown = "only root can read its rules: sudo lcmtools wtf, or sudo nft list ruleset"
    elif not readers:
        unknown = "neither nft nor iptables-save is installed, which would show its rules"
    for name, command in readers.items() if not unknown else ():
        if chain := refusing_chain(_output(command), traffic):
            return name, chain, ""
    return "", "", unknown


def _output(command: Sequence[str]) -> str:
    with contextlib.suppress(OSError, subprocess.TimeoutExpired):
        return subprocess.run(  # noqa: S603 - a fixed command
            command, capture_output=True, text=True, timeout=_TIMEOUT, check=False
        ).stdout
    return ""


def text_of(file: Path) -> str:
    """Return the text of a file; "" if it cannot be read."""
    with contextlib.suppress(OSError):
        return file.read_text(errors="replace")
    return ""


def _number(file: Path) -> int:
    with contextlib.suppress(ValueError):
        return int(text_of(file) or 0)  # int("") may lose a Ctrl-C
    return 0


def large_problem(url: BusUrl) -> str:
    """Return the reason why a large message does not come back to this computer; "" if it does.

    Each datagram is read before the next one is sent, so that the size of the buffer
    does not matter.
    """
    try:
        check_route(url)
        check_multicast(url)
    except BusError:
        return ""  # not even a small one does, which is another fault
    try:
        free_port = url._replace(port=0)
        with receiving_socket(free_port, is_brief=True) as receiver, sending_socket(url) as sender:
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            address = (url.host, receiver.getsockname()[1])
            parts = list(fragments(0, _CHANNEL, bytes(LARGE_BYTES)))
            for number, part in enumerate(parts, start=1):
                sender.sendto(part, address)
                has_come = select.select([receiver], [], [], _ARRIVAL_TIME)[0]
                if not has_come or receiver.recv(_LARGEST_DATAGRAM) != part:
                    return f"part {number} of {len(parts)}, {len(part)} bytes, is lost"
    except BusError as error:
        return error.what
    except OSError as error:
        if error.errno == errno.EMSGSIZE:
            return "the system does not send datagrams as large as LCM's"
        return f"{error.strerror}"
    return ""


def send_problem(url: BusUrl) -> tuple[str, str]:
    """Return the reason why nothing can be sent with the bus's ttl, and a remedy; else ""."""
    try:
        check_sending(url)
    except BusError as error:
        return error.what, error.hint
    return "", ""
