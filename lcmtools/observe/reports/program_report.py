"""A program that is not a node, as lines of text and as values for JSON."""

import socket
import time
from collections.abc import Sequence

from lcmtools.bus.processes import Process
from lcmtools.bus.sockets import SocketTable
from lcmtools.graph.command_line import LONGEST_COMMAND, shortened
from lcmtools.graph.model import Traffic
from lcmtools.observe.node_requests import program_place
from lcmtools.observe.reading.senders import Program, user_name
from lcmtools.observe.reports.describe import (
    Kinds,
    candidates_text,
    kinds_text,
    seen_kinds,
    types_json,
)
from lcmtools.text_table import plural


def listed_rows(program: Program) -> list[str]:
    """Return a program as ``node list -a`` shows it: its place, command and role."""
    user = f" (user {program.user})" if program.user else ""
    bus = f", on {program.bus}" if program.bus else ""
    parts = [f"publishes {', '.join(program.channels)}"] if program.channels else []
    if program.listens:
        lost = sum(row.drops for row in program.sockets)
        parts.append(f"listens ({plural(lost, 'datagram')} dropped so far)" if lost else "listens")
    text = f"{program_place(program)} \t{command_text(program)}{user}{bus}"
    return [text, f"\t{', '.join(parts)}"]


def listeners_text(listeners: Sequence[Program] | None) -> str:
    """Return the programs that may receive a topic; "" for none that is seen."""
    return ", ".join(map(program_text, listeners or ()))


def listeners_json(listeners: Sequence[Program] | None) -> list[dict[str, object]] | None:
    """Return the same for JSON; null if they cannot be seen."""
    if listeners is None:
        return None
    return [{"program": program_text(one), "pid": pid_of(one)} for one in listeners]


def to_lines(program: Program, now: int, *, quiet: bool) -> list[str]:
    """Return a program as ``node info`` shows it."""
    found = ["-" * 80, f"Program [{command_text(program)}] (no node: seen on the bus only)"]
    types = {seen.channel: kinds_text(_kinds(seen), seen.channel) for seen in program.traffic}
    found.append("Publications: " if types else "Publications: none seen")
    found += [f" * {channel} [{text}]" for channel, text in types.items()]
    listens = {True: "on unknown channels", False: "None", None: "not known"}
    found += ["", f"Subscriptions: {listens[program.listens]}", "", ""]
    if quiet:
        return found
    found.append(f"Host: {program_place(program).rpartition(':')[0]}")
    if process := program.process:
        found += [
            f"Pid: {process.pid}",
            f"Command: {process.command}",
            *usage_rows(process, now),
        ]
    sizes = SocketTable.read().buffers if program.sockets else {}
    found += [
        f"Buffer: {_kilobytes(row.queued_bytes)} of {_kilobytes(sizes.get(row.inode))} wait,"
        f" {plural(row.drops, 'datagram')} dropped"
        for row in program.sockets
    ]
    return [*found, f"Ports: {', '.join(map(str, program.ports)) or 'none seen'}", ""]


def to_json(program: Program) -> dict[str, object]:
    """Return a program for JSON, with the keys of a node that are known."""
    process = program.process
    elsewhere = program.address if program.observer else ""
    return {
        "observed": True,
        "node": None,
        "host": socket.gethostname() if process else elsewhere or None,
        "address": None if elsewhere else program.address or None,
        "ports": list(program.ports),
        "pid": process.pid if process else None,
        "command": process.command if process else None,
        "user": program.user or None,
        "publications": [
            {
                "topic": seen.channel,
                **types_json(_kinds(seen), seen.channel),
                "messages": seen.messages,
                "bytes": seen.bytes,
                "rate": seen.rate(),
            }
            for seen in program.traffic
        ],
        "listens": program.listens,
        "queued_bytes": sum(row.queued_bytes for row in program.sockets),
        "drops": sum(row.drops for row in program.sockets),
        "candidates": [process.pid for process in program.candidates],
        **({"bus": program.bus, "relays": [program.observer]} if program.bus else {}),
    }


def command_text(program: Program) -> str:
    """Return a program's name and arguments, as far as the system knows."""
    if program.process:
        return shortened(program.process.command, LONGEST_COMMAND)
    return f"a program{candidates_text(program.candidates)}"


def pid_of(program: Program) -> int | None:
    """Return a program's pid; None if it is not shown."""
    return program.process.pid if program.process else None


def program_text(program: Program) -> str:
    """Return a program's name with its pid, or its user."""
    shown = [f"pid {pid_of(program)}"] if program.process else []
    shown += [] if shown or not program.user else [f"user {program.user}"]
    return " ".join((command_text(program), *(f"({one})" for one in shown)))


def _kinds(seen: Traffic) -> Kinds:
    return seen_kinds(seen.fingerprints, seen.channel)


def _kilobytes(size: int | None) -> str:
    return "an unknown size" if size is None else f"{size / 1e3:.0f} kB"


def usage_rows(process: Process, now: int) -> list[str]:
    """Return the resources that a process of this computer uses; none if the system hides them."""
    taken = process.usage()
    if taken is None:
        return []
    started = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(taken.start_time / 1e9))
    share = percent(taken.processor_time, (now - taken.start_time) / 1e9)
    return [
        f"User: {user_name(taken.uid)}",
        f"Started: {started}",
        f"Memory: {taken.memory_bytes / 1e6:.1f} MB",
        f"Processor: {share} of a core since it started",
    ]


def percent(spent: float, seconds: float) -> str:
    """Return a share of some time as text."""
    return f"{100 * spent / max(1e-9, seconds):.1f} %"
