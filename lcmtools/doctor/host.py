"""The parts of this computer that bear on a bus, read from /proc and /sys where these exist.

Belongs here: all that ``wtf`` reads besides the bus. Must not judge.
"""

import contextlib
import fcntl
import os
import socket
import struct
import sys
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from ipaddress import IPv4Address
from pathlib import Path
from typing import Any

from lcmtools.bus.processes import Process, UdpSocket, process_of, uses_lcm
from lcmtools.bus.url import BusUrl, choose_url, misread_options
from lcmtools.doctor.evidence import Host, LcmProcess
from lcmtools.doctor.firewall import firewall
from lcmtools.doctor.self_test import LARGE_BYTES, large_problem, send_problem
from lcmtools.errors import LcmtoolsError

_PROC, _NET = Path("/proc"), Path("/sys/class/net")
_UP, _MULTICAST = 0x1, 0x1000  # linux/if.h
_WORKS = _UP | _MULTICAST
_GET_FLAGS = 0x8913  # linux/sockios.h; /sys may show another network's interfaces
_KNOWN_GROUPS = frozenset({"224.0.0.251", "239.255.255.250", "224.0.0.252"})  # mDNS, SSDP, LLMNR
_TYPE_PACKAGES = ("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs")
_VARIABLES = ("LCM_DEFAULT_URL", "LCMTOOLS_DOMAIN")


def host(url: BusUrl, environment: Mapping[str, str]) -> Host:
    """This computer, as it bears on a bus."""
    interface = route_interface(url.host) if url.is_multicast else ""
    folder = _NET / interface if interface else Path("/nonexistent")
    flags = _flags(interface or "lo") if url.is_multicast else _WORKS  # where a route would lead
    return Host(
        uid=os.getuid(),
        interface=interface,
        is_up=bool(flags & _UP),
        can_multicast=bool(flags & _MULTICAST) or not interface,
        joined=_joined(url.host) if url.is_multicast else (),
        rp_filter=max(
            _number(_PROC / f"sys/net/ipv4/conf/{name}/rp_filter")
            for name in ("all", interface or "all")
        ),
        speed_mbit=max(0, _number(folder / "speed")),
        is_wireless=(folder / "wireless").exists(),
        receive_buffer=_number(_PROC / "sys/net/core/rmem_default"),
        most_receive_buffer=_number(_PROC / "sys/net/core/rmem_max"),
        container=_container(),
        environment=(
            *_environment(environment),
            *(f"the URL {url}: {odd}" for odd in misread_options(url)),
        ),
        has_sockets=(_PROC / "net/udp").exists(),
        **(_network(url, interface) if url.is_multicast else {}),
    )


def _network(url: BusUrl, interface: str) -> dict[str, Any]:
    """The parts that bear on messages that leave this computer, and the self test."""
    known: dict[str, Any] = {"large_bytes": LARGE_BYTES, "large_problem": large_problem(url)}
    if url.ttl:
        folder = _NET / interface
        known["firewall"], known["firewall_unknown"] = firewall()
        known["send_problem"], known["send_remedy"] = send_problem(url)
        known["others"] = tuple(sorted(_routed_interfaces() - {interface, "lo"}))
        known["is_virtual"] = _number(folder / "iflink") != _number(folder / "ifindex")
        known["bridge"] = silent_bridge(interface)
    return known


def silent_bridge(interface: str) -> str:
    """The bridge that an interface is, or is a port of, if it snoops without a querier; else ""."""
    folder = _NET / interface
    if not interface or not folder.exists():
        return ""
    bridge = folder if (folder / "bridge").exists() else (folder / "master").resolve()
    settings = bridge / "bridge"
    snoops = _number(settings / "multicast_snooping") == 1
    return bridge.name if snoops and not _number(settings / "multicast_querier") else ""


def route_interface(group: str) -> str:
    """The interface that the route to a group leads to; "" where that is not known."""
    best, found = -1, ""
    for line in _text(_PROC / "net/route").splitlines()[1:]:
        columns = line.split()
        with contextlib.suppress(ValueError, IndexError):
            network, mask = int(columns[1], 16), int(columns[7], 16)
            own = struct.unpack("=I", socket.inet_aton(group))[0]
            if own & mask == network and mask.bit_count() > best:
                best, found = mask.bit_count(), columns[0]
    return found


def _flags(interface: str) -> int:
    """An interface's flags; those of one that works where the system does not tell."""
    if not _PROC.joinpath("net/route").exists():
        return _WORKS
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        request = struct.pack("16s16x", interface.encode())
        return int(struct.unpack_from("=16xH", fcntl.ioctl(asking, _GET_FLAGS, request))[0])
    return _WORKS


def _routed_interfaces() -> set[str]:
    """The interfaces to which any route leads."""
    rows = _text(_PROC / "net/route").splitlines()[1:]
    return {columns[0] for row in rows if (columns := row.split())}


def reassembly_failures() -> int:
    """IP datagrams so far whose pieces did not all come."""
    rows = [line.split() for line in _text(_PROC / "net/snmp").splitlines() if line[:3] == "Ip:"]
    with contextlib.suppress(ValueError, IndexError):
        return int(rows[1][rows[0].index("ReasmFails")])
    return 0


def state_of(pid: int) -> str:
    """A process's state as ps shows it; "" where there is none."""
    return _text(_PROC / str(pid) / "stat").rpartition(")")[2].strip()[:1]


def busy_time(pid: int) -> int:
    """The time that a process's first thread has computed, or waited for a processor [ns]."""
    numbers = _text(_PROC / str(pid) / "schedstat").split()
    return int(numbers[0]) + int(numbers[1]) if len(numbers) > 1 else 0


def waited_time(pid: int) -> int:
    """The time that a process's threads have waited for a processor, all together [ns]."""
    files = (_PROC / str(pid) / "task").glob("*/schedstat")
    numbers = [_text(file).split() for file in files]
    return sum(int(row[1]) for row in numbers if len(row) > 1)


def never_reads(pid: int) -> bool:
    """Return whether a process only sends, although it has a socket that receives.

    lcm.jar makes one for sending too, and starts a thread that reads with the first subscription.
    """
    if Path(_text(_PROC / str(pid) / "cmdline").partition("\0")[0]).name != "java":
        return False
    names = [_text(file) for file in (_PROC / str(pid) / "task").glob("*/comm")]
    return not any(name.startswith("Thread-") for name in names)


def lcm_processes(
    url: BusUrl, sockets: Iterable[UdpSocket], holders: Mapping[int, Process], seen: set[int]
) -> tuple[LcmProcess, ...]:
    """The processes of this user that have to do with LCM, with where they are.

    Those that listen to a multicast group are there. One that only sends is where it was seen
    (its port is one of ``seen``), or else where its variables say.
    """
    buses: dict[int, str] = {}
    sending: dict[int, set[int]] = {}
    own = os.getuid()
    for row in sockets:
        process = holders.get(row.inode)
        multicast = IPv4Address(row.address).is_multicast and row.address not in _KNOWN_GROUPS
        if not process or row.uid != own or process.pid == os.getpid():
            continue
        if row.port == url.port and (row.address == url.host or not multicast):
            buses[process.pid] = ""
        elif multicast:
            buses.setdefault(process.pid, f"{row.address}:{row.port}")
        else:
            sending.setdefault(process.pid, set()).add(row.port)
    found = [_lcm_process(pid, bus) for pid, bus in sorted(buses.items())]
    for pid, ports in sorted(sending.items()):
        if pid not in buses and uses_lcm(pid):
            bus = "" if ports & seen else _said_bus(pid, url)
            found.append(_lcm_process(pid, bus))
    return tuple(found)


def _said_bus(pid: int, url: BusUrl) -> str:
    """The bus that a process's variables name, where that is another multicast one."""
    with contextlib.suppress(LcmtoolsError):
        said, _ = choose_url("", "", _variables(pid))
        if said.is_multicast and (said.host, said.port) != (url.host, url.port):
            return f"{said.host}:{said.port}"
    return ""


def _variables(pid: int) -> dict[str, str]:
    entries = _text(_PROC / str(pid) / "environ").split("\0")
    pairs = dict(entry.partition("=")[::2] for entry in entries if entry)
    return {name: pairs[name] for name in _VARIABLES if pairs.get(name)}


def _lcm_process(pid: int, bus: str) -> LcmProcess:
    process = process_of(pid)
    folder = _PROC / str(pid)
    limits = [line.split() for line in _text(folder / "limits").splitlines()]
    most = next((row[3] for row in limits if row[:3] == ["Max", "open", "files"]), "0")
    open_files = 0
    with contextlib.suppress(OSError):
        open_files = sum(1 for _ in (folder / "fd").iterdir())
    return LcmProcess(
        pid,
        process.command if process else "",
        bus,
        next((f"{name}={value}" for name, value in _variables(pid).items()), ""),
        open_files,
        int(most) if most.isdigit() else 0,
        state_of(pid),
    )


def _joined(group: str) -> tuple[str, ...]:
    """The interfaces on which the group is joined."""
    packed = f"{struct.unpack('=I', socket.inet_aton(group))[0]:08X}"
    found, interface = [], ""
    for line in _text(_PROC / "net/igmp").splitlines()[1:]:
        columns = line.split()
        if columns and not line[0].isspace():
            interface = columns[1].rstrip(":")
        elif columns and columns[0] == packed:
            found.append(interface)
    return tuple(found)


def _container() -> str:
    if "microsoft" in _text(_PROC / "version").lower():
        return "WSL"
    files = (Path("/.dockerenv"), Path("/run/.containerenv"))
    return "container" if any(file.exists() for file in files) else ""


def _environment(environment: Mapping[str, str]) -> Iterable[str]:
    for name in ("PYTHONPATH", "LCMTOOLS_TYPE_PATH"):
        for part in environment.get(name, "").split(os.pathsep):
            if part and not Path(part).exists():
                yield f"{name} has {part}, which does not exist"
    yield from _found_twice(environment)
    spec = find_spec("lcm")
    if spec is None:
        yield "the Python package lcm is missing: nodes cannot run"
    elif spec.origin and "-packages" not in spec.origin:
        yield f"'import lcm' finds {spec.origin}, which may not be LCM's package"
    try:
        choose_url("", "", environment)
    except LcmtoolsError as error:
        yield str(error)


def _found_twice(environment: Mapping[str, str]) -> Iterable[str]:
    """Packages of types that lie in several places, as ROS's and ones made by lcm-gen do."""
    folders = [*environment.get("PYTHONPATH", "").split(os.pathsep), *sys.path]
    for name in _TYPE_PACKAGES:
        places = {Path(f, name).resolve(): None for f in folders if f and Path(f, name).is_dir()}
        if len(places) > 1:
            yield f"Python finds {name} in {' and in '.join(map(str, places))}; the first counts"


def _text(file: Path) -> str:
    try:
        return file.read_text(errors="replace")
    except OSError:
        return ""


def _number(file: Path) -> int:
    try:
        return int(_text(file))
    except ValueError:
        return 0
