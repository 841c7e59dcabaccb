"""The firewall of this computer, as far as this user may know."""

import os
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

_UFW = Path("/etc/ufw/ufw.conf")
_FIREWALLD = Path("/run/firewalld.pid")
_READERS = {"nftables": ("nft", "list", "ruleset"), "iptables": ("iptables-save",)}
_TIMEOUT = 2.0  # [s]
_MET = re.compile(r"\bhook (input|output)\b")
_JUMPS = frozenset({"jump", "goto", "-j", "-g"})
_REFUSALS = frozenset({"drop", "reject", "DROP", "REJECT"})


def firewall() -> tuple[str, str]:
    """The name of a firewall that may drop datagrams, and the reason if that is not known.

    Both are empty where none is at work; at most one is not.
    """
    if "ENABLED=yes" in _text(_UFW):
        return "ufw", ""
    if _FIREWALLD.exists():
        return "firewalld", ""
    if not Path("/proc").exists():
        return "", "its rules are not known on this system"
    if os.getuid() != 0:
        return "", "only root can read its rules: sudo lcmtools wtf, or sudo nft list ruleset"
    return _read_rules()


def _read_rules() -> tuple[str, str]:
    readers = {name: command for name, command in _READERS.items() if shutil.which(command[0])}
    if not readers:
        return "", "neither nft nor iptables-save is installed, which would show its rules"
    found = (name for name, command in readers.items() if refuses(_output(command)))
    return next(found, ""), ""


@dataclass(slots=True)
class _Chain:
    is_met: bool = False  # by datagrams that come in or leave, without any jump
    refuses: bool = False
    jumps: set[str] = field(default_factory=set)


def refuses(rules: str) -> bool:
    """Return whether rules, as nft or iptables-save print them, drop incoming or outgoing traffic.

    What is only forwarded for others, as Docker's rules are about, does not count.
    """
    chains: dict[str, _Chain] = {}
    current = ""
    for line in rules.splitlines():
        words = line.replace(";", " ").split()
        if words[:1] in (["chain"], ["-A"]) and len(words) > 1:
            current = words[1]
        elif words and words[0][:1] == ":":
            current = words[0][1:]
        chain = chains.setdefault(current, _Chain())
        chain.is_met |= current in ("INPUT", "OUTPUT") or bool(_MET.search(line))
        chain.refuses |= bool(_REFUSALS & set(words))
        chain.jumps |= {b for a, b in pairwise(words) if a in _JUMPS}
    return _meets_refusal(chains)


def _meets_refusal(chains: Mapping[str, _Chain]) -> bool:
    waiting = [name for name, chain in chains.items() if chain.is_met]
    seen: set[str] = set()
    while waiting:
        name = waiting.pop()
        if name in seen or name not in chains:
            continue
        seen.add(name)
        if chains[name].refuses:
            return True
        waiting += chains[name].jumps
    return False


def _output(command: Sequence[str]) -> str:
    try:
        done = subprocess.run(  # noqa: S603 - a fixed command
            command, capture_output=True, text=True, timeout=_TIMEOUT, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout


def _text(file: Path) -> str:
    try:
        return file.read_text(errors="replace")
    except OSError:
        return ""
