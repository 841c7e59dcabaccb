"""Records of the nodes that run on this computer, so that killed nodes are noticed.

A node that ends says goodbye on the bus; a killed one cannot. Each node keeps a small file while it
lives; if its node does not answer, a file shows that it ended. The files belong to one user.
"""

import contextlib
import json
import os
import socket
import stat
import sys
import time
import uuid
from collections.abc import Container, Iterator, Mapping
from pathlib import Path

from lcmtools.bus.kernel import network_cookie, own_network, own_pid_namespace
from lcmtools.bus.processes import command_text, process_of
from lcmtools.bus.url import BusUrl
from lcmtools.graph.model import NodeInfo, Role, Staleness
from lcmtools.graph.protocol import SOFTWARE

_FOLDER = "records"  # "nodes" before version 1 of the protocol


class NodeRecords:
    """The records of one bus, or, to be read, of all, in XDG_RUNTIME_DIR of the environment."""

    def __init__(self, url: BusUrl | None, environment: Mapping[str, str]) -> None:
        bases = [base / _FOLDER for base in _base_folders(environment)]
        every = [base / url.file_name for base in bases] if url else []
        self._folders = every or [folder for base in bases for folder in base.glob("*")]

    def write(self, node: NodeInfo) -> bool:
        """Write a node's record, and remove those of dead nodes of its name.

        Return False if no folder takes it: other users' folders, or a full disk.
        """
        for dead in self.read():
            if dead.name == node.name and dead.stale is Staleness.ENDED:
                self.remove(dead.id)
        process = process_of(os.getpid())
        record = {  # keys may be added, but are never removed or changed
            "version": node.version,
            "name": node.name,
            "id": node.id,
            "host": node.host,
            "pid": node.pid,
            "start_time": node.start_time,
            "command": node.command,
            "start_ticks": process.start_ticks if process else 0,
            **_own_namespaces(),
            "publishes": [one.topic for one in node.having(Role.PUBLISHER)],
            "subscribes": [one.topic for one in node.having(Role.SUBSCRIBER)],
        }
        return any(_is_written(folder, node.id, json.dumps(record)) for folder in self._folders)

    def remove(self, identifier: str) -> None:
        """Remove a node's record."""
        for folder in self._folders:
            with contextlib.suppress(OSError):
                (folder / f"{identifier}.json").unlink(missing_ok=True)

    def read(self, but: Container[str] = ()) -> Iterator[NodeInfo]:
        """Yield the nodes with a record, each with its staleness if it does not answer.

        A node in another network namespace of this computer, for example in a container, is on
        another bus, and the pid of one in another pid namespace means nothing here. Nodes with an
        id in ``but`` are left out, unread.
        """
        for record in self._records(but):
            with contextlib.suppress(ValueError, KeyError, TypeError):
                pid = int(str(record["pid"]))
                process = process_of(pid)
                starts = 0, record.get("start_ticks")  # 0 where the system does not show it
                is_alive = process is not None and process.start_ticks in starts
                yield NodeInfo(
                    name=str(record["name"]),
                    id=str(record["id"]),
                    host=str(record["host"]),
                    pid=pid,
                    start_time=int(str(record.get("start_time", 0))),
                    command=str(record.get("command", "")),
                    stale=Staleness.HANGS if is_alive else Staleness.ENDED,
                )

    def namesake(self, node: NodeInfo) -> NodeInfo | None:
        """Return a node of the same name that another process of this computer runs, if any."""
        alive = (one for one in self.read() if one.stale is Staleness.HANGS)
        return next((one for one in alive if one.name == node.name and one.pid != node.pid), None)

    def topics(self, identifiers: Container[str], role: Role) -> set[str]:
        """Return the topics that nodes with these ids published or subscribed to."""
        found: set[str] = set()
        for record in self._records():
            topics = record.get("publishes" if role is Role.PUBLISHER else "subscribes")
            if record.get("id") in identifiers and isinstance(topics, list):
                found.update(map(str, topics))
        return found

    def _records(self, but: Container[str] = ()) -> Iterator[Mapping[str, object]]:
        here = _own_namespaces()
        for folder in filter(_is_private, self._folders):
            for path in sorted(folder.glob("*.json")):
                with contextlib.suppress(OSError, ValueError, AttributeError):
                    record = {} if path.stem in but else json.loads(path.read_text())
                    if record and all(record.get(key, own) == own for key, own in here.items()):
                        yield record


def this_process(name: str, *, tool: bool) -> NodeInfo:
    """Return this process as a node of this name; a tool is a command that only observes."""
    return NodeInfo(
        name=name,
        id=uuid.uuid4().hex,
        host=socket.gethostname(),
        pid=os.getpid(),
        start_time=time.time_ns(),
        command=command_text(sys.argv),
        tool=tool,
        software=SOFTWARE,
        pid_namespace=own_pid_namespace(),
    )


def recorded_pids(environment: Mapping[str, str]) -> frozenset[int]:
    """Return the processes of this user's nodes that run, on any bus."""
    every = NodeRecords(None, environment).read()
    return frozenset(one.pid for one in every if one.stale is Staleness.HANGS)


def _is_written(folder: Path, identifier: str, record: str) -> bool:
    """Write a record into a folder, which is made if need be; return False if that fails."""
    with contextlib.suppress(OSError):
        for part in (folder.parent.parent, folder.parent, folder):
            part.mkdir(mode=0o700, exist_ok=True)  # parents=True would heed the umask only
        if _is_private(folder):
            temporary = folder / f".{identifier}"
            temporary.write_text(record)
            temporary.replace(folder / f"{identifier}.json")
            return True
    return False


def _own_namespaces() -> dict[str, int]:
    """Return the numbers of this process's namespaces. A later network may get the same number."""
    return {
        "network": own_network(),
        "network_cookie": network_cookie(),
        "pid_namespace": own_pid_namespace(),
    }


def _base_folders(environment: Mapping[str, str]) -> list[Path]:
    """Return the folders of records, those to write to first: the user's runtime folder, /tmp.

    A runtime folder of another user, as ``sudo -E`` gives it, is left alone: what root makes in it
    shuts that user out.
    """
    shared = Path(f"/tmp/lcmtools-{os.getuid()}")  # noqa: S108 - private, and checked to be
    runtime = environment.get("XDG_RUNTIME_DIR", "")
    with contextlib.suppress(OSError, ValueError):
        if stat.S_ISDIR((status := os.stat(runtime)).st_mode) and status.st_uid == os.getuid():  # noqa: PTH116
            return [Path(runtime) / "lcmtools", shared]
    return [shared]


def _is_private(folder: Path) -> bool:
    """Return whether the folder exists and other users cannot write into it."""
    try:
        status = folder.lstat()
        base = folder.parent.parent.lstat()
    except OSError:
        return False
    return (
        stat.S_ISDIR(status.st_mode)
        and status.st_uid == base.st_uid == os.getuid()
        and not base.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    )
