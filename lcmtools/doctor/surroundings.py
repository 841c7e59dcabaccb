"""What of this computer bears on a bus, read from /proc and /sys; nothing where there is none.

Belongs here: all that ``wtf`` reads besides the bus. Must not judge.
"""

import contextlib
import os
import socket
import struct
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from ipaddress import IPv4Address
from pathlib import Path

from lcmtools.bus.processes import Process, UdpSocket, process_of
from lcmtools.bus.url import BusUrl, choose_url
from lcmtools.doctor.model import Host, LcmProcess
from lcmtools.errors import LcmtoolsError

_PROC, _NET = Path("/proc"), Path("/sys/class/net")
_UP, _MULTICAST = 0x1, 0x1000  # linux/if.h
_KNOWN_GROUPS = frozenset({"224.0.0.251", "239.255.255.250", "224.0.0.252"})  # mDNS, SSDP, LLMNR
_VARIABLES = ("LCM_DEFAULT_URL", "LCMTOOLS_DOMAIN")


def host(url: BusUrl, environment: Mapping[str, str]) -> Host:
    """This computer, as it bears on a bus."""
    interface = route_interface(url.host) if url.is_multicast else ""
    folder = _NET / interface if interface else Path("/nonexistent")
    flags = int(_text(folder / "flags") or "0x1001", 16)
    return Host(
        uid=os.getuid(),
        interface=interface,
        is_up=bool(flags & _UP),
        can_multicast=bool(flags & _MULTICAST),
        joined=_joined(url.host) if url.is_multicast else (),
        rp_filter=max(
            _number(_PROC / f"sys/net/ipv4/conf/{name}/rp_filter")
            for name in ("all", interface or "all")
        ),
        speed_mbit=max(0, _number(folder / "speed")),
        is_wireless=(folder / "wireless").exists(),
        receive_buffer=_number(_PROC / "sys/net/core/rmem_default"),
        most_receive_buffer=_number(_PROC / "sys/net/core/rmem_max"),
        firewall="ufw" if "ENABLED=yes" in _text(Path("/etc/ufw/ufw.conf")) else "",
        container=_container(),
        environment=tuple(_environment(environment)),
    )


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
    """How long a process's first thread has computed, or waited for a processor [ns]."""
    numbers = _text(_PROC / str(pid) / "schedstat").split()
    return int(numbers[0]) + int(numbers[1]) if len(numbers) > 1 else 0


def lcm_processes(
    url: BusUrl, sockets: Iterable[UdpSocket], holders: Mapping[int, Process]
) -> tuple[LcmProcess, ...]:
    """The processes of this user that listen to a multicast group, with where they are."""
    buses: dict[int, str] = {}
    own = os.getuid()
    for row in sockets:
        process = holders.get(row.inode)
        multicast = IPv4Address(row.address).is_multicast and row.address not in _KNOWN_GROUPS
        if not process or row.uid != own or process.pid == os.getpid():
            continue
        here = row.port == url.port and (row.address == url.host or not multicast)
        if here:
            buses[process.pid] = ""
        elif multicast:
            buses.setdefault(process.pid, f"{row.address}:{row.port}")
    return tuple(_lcm_process(pid, bus) for pid, bus in sorted(buses.items()))


def _lcm_process(pid: int, bus: str) -> LcmProcess:
    process = process_of(pid)
    folder = _PROC / str(pid)
    limits = [line.split() for line in _text(folder / "limits").splitlines()]
    most = next((row[3] for row in limits if row[:3] == ["Max", "open", "files"]), "0")
    open_files = 0
    with contextlib.suppress(OSError):
        open_files = sum(1 for _ in (folder / "fd").iterdir())
    variables = dict(
        entry.partition("=")[::2] for entry in _text(folder / "environ").split("\0") if entry
    )
    set_ones = [f"{name}={variables[name]}" for name in _VARIABLES if variables.get(name)]
    command = process.command if process else ""
    return LcmProcess(
        pid, command, bus, next(iter(set_ones), ""), open_files, int(most) if most.isdigit() else 0
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
    spec = find_spec("lcm")
    if spec is None:
        yield "the Python package lcm is missing: nodes cannot run"
    elif spec.origin and "-packages" not in spec.origin:
        yield f"'import lcm' finds {spec.origin}, which may not be LCM's package"
    try:
        choose_url("", "", environment)
    except LcmtoolsError as error:
        yield str(error)


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
