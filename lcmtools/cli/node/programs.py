"""How the node commands show programs that are no nodes."""

import socket

from lcmtools.bus.socket_diag import receive_buffers
from lcmtools.cli.describe import UNKNOWN, candidates_text
from lcmtools.graph.model import Traffic
from lcmtools.messages.registry import candidates
from lcmtools.observe.programs import Program

HEADING = "Programs that are no nodes (seen on the bus):"


def listed_program(program: Program) -> list[str]:
    """A program as ``node list -a`` shows it: where it runs, its command, what it does."""
    user = f" (user {program.user})" if program.user else ""
    return [f"{place(program)} \t{command(program)}{user}", f"\t{doing(program)}"]


def place(program: Program) -> str:
    """Where a program runs: "host:pid", or the address that its messages come from."""
    if program.process:
        return f"{socket.gethostname()}:{program.process.pid}"
    if program.ports:
        return f"{program.address}:{program.ports[0]}"
    return program.address or "unknown address"


def command(program: Program) -> str:
    """What a program was started as, as far as the system tells."""
    if program.process:
        return program.process.command
    return f"a program{candidates_text(program.candidates)}"


def doing(program: Program) -> str:
    """What a program does on the bus."""
    parts = [f"publishes {', '.join(program.channels)}"] if program.channels else []
    if program.listens:
        lost = sum(row.drops for row in program.sockets)
        parts.append(f"listens ({lost} datagrams dropped so far)" if lost else "listens")
    return ", ".join(parts)


def listening(program: Program) -> list[str]:
    """How a program's listening fares: what waits in its buffers, and what they have lost."""
    sizes = receive_buffers() if program.sockets else {}
    return [
        f"Buffer: {_kilobytes(row.queued_bytes)} of {_kilobytes(sizes.get(row.inode))} wait,"
        f" {row.drops} datagrams dropped since it listens"
        for row in program.sockets
    ]


def _kilobytes(size: int | None) -> str:
    return "an unknown size" if size is None else f"{size / 1e3:.0f} kB"


def program_record(program: Program) -> dict[str, object]:
    """A program for JSON, with the keys of a node where they are known."""
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
        "publications": [_seen_record(seen) for seen in program.traffic],
        "listens": program.listens,
        "queued_bytes": sum(row.queued_bytes for row in program.sockets),
        "drops": sum(row.drops for row in program.sockets),
        "candidates": [process.pid for process in program.candidates],
    }


def seen_type(seen: Traffic) -> str:
    """The type that messages are likely of, by their fingerprints."""
    names = [found[0] for value in seen.fingerprints if (found := candidates(value))]
    return ", ".join(dict.fromkeys(names)) or UNKNOWN


def _seen_record(seen: Traffic) -> dict[str, object]:
    return {
        "topic": seen.channel,
        "type": seen_type(seen),
        "messages": seen.messages,
        "bytes": seen.bytes,
        "rate": seen.rate(),
    }


def is_meant(program: Program, word: str) -> bool:
    """Whether a word on the command line means a program: its pid, or a word of its command.

    Or where it runs, as ``node list -a`` says it.
    """
    if word == place(program):
        return True
    if program.process is None:
        return False
    parts = [part.rpartition("/")[2] for part in program.process.command.split()]
    return word == str(program.process.pid) or word in (program.process.command, *parts)
