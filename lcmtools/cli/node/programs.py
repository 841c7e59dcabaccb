"""Programs that are no nodes, as the node commands show them."""

import socket

from lcmtools.bus.kernel import receive_buffers
from lcmtools.graph.model import Traffic
from lcmtools.messages.registry import candidates
from lcmtools.observe.describe import UNKNOWN, candidates_text
from lcmtools.observe.nodes import program_place
from lcmtools.observe.programs import Program


def program_rows(program: Program) -> list[str]:
    """Return a program as ``node list -a`` shows it: its place, its command, its part."""
    user = f" (user {program.user})" if program.user else ""
    parts = [f"publishes {', '.join(program.channels)}"] if program.channels else []
    if program.listens:
        lost = sum(row.drops for row in program.sockets)
        parts.append(f"listens ({lost} datagrams dropped so far)" if lost else "listens")
    return [f"{program_place(program)} \t{command_text(program)}{user}", f"\t{', '.join(parts)}"]


def program_sections(program: Program, usage: list[str], *, quiet: bool) -> list[str]:
    """Return a program as ``node info`` shows it; ``usage`` is that of its process."""
    rows = ["-" * 80, f"Program [{command_text(program)}] (no node: seen on the bus only)"]
    published = {
        seen.channel: f" * {seen.channel} [{_type_text(seen)}]" for seen in program.traffic
    }
    rows += ["Publications: ", *published.values()] if published else ["Publications: none seen"]
    listens = {True: "on channels that LCM does not tell", False: "None", None: "not known"}
    rows += ["", f"Subscriptions: {listens[program.listens]}", "", ""]
    if quiet:
        return rows
    rows.append(f"Host: {program_place(program).rpartition(':')[0]}")
    if program.process:
        rows += [f"Pid: {program.process.pid}", f"Command: {program.process.command}", *usage]
    sizes = receive_buffers() if program.sockets else {}
    rows += [
        f"Buffer: {_kilobytes(row.queued_bytes)} of {_kilobytes(sizes.get(row.inode))} wait,"
        f" {row.drops} datagrams dropped since it listens"
        for row in program.sockets
    ]
    return [*rows, f"Ports: {', '.join(map(str, program.ports)) or 'none seen'}", ""]


def program_record(program: Program) -> dict[str, object]:
    """Return a program for JSON, with the keys of a node where they are known."""
    process = program.process
    return {
        "observed": True,
        "node": None,
        "host": socket.gethostname() if process else None,
        "address": program.address or None,
        "ports": list(program.ports),
        "pid": process.pid if process else None,
        "command": process.command if process else None,
        "user": program.user or None,
        "publications": [
            {
                "topic": seen.channel,
                "type": _type_text(seen),
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
    }


def command_text(program: Program) -> str:
    """Return a program's command line, as far as the system tells."""
    if program.process:
        return program.process.command
    return f"a program{candidates_text(program.candidates)}"


def _type_text(seen: Traffic) -> str:
    """The type that messages are likely of, by their fingerprints."""
    names = [found[0] for value in seen.fingerprints if (found := candidates(value))]
    return ", ".join(dict.fromkeys(names)) or UNKNOWN


def _kilobytes(size: int | None) -> str:
    return "an unknown size" if size is None else f"{size / 1e3:.0f} kB"
