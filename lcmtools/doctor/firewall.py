"""The rules of a firewall, as nft or iptables-save print them, and what they do to a bus.

Pure: text in, the chain that refuses the bus's datagrams out. A rule concerns the bus if everything
in it that is understood fits: UDP, the bus's port, group and interface. One that is limited in
another way, such as to some computers, decides nothing.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from ipaddress import (
    IPv4Address,
    IPv4Network,
    IPv6Network,
    ip_network,
    summarize_address_range,
)
from typing import NamedTuple

_DIRECTIONS = {"INPUT": "input", "OUTPUT": "output"}
_HOOK = re.compile(r"\bhook (input|output)\b")
_POLICY = re.compile(r"\bpolicy (\w+)")
_FAMILIES = ("ip", "inet")  # of nft's tables; others, such as ip6, do not see the bus
_VERDICTS = {"accept": "accept", "drop": "refuse", "reject": "refuse", "return": "return"}
_JUMPS = frozenset({"jump", "goto"})
_UDP = frozenset({"udp", "17", "all", "0", "ip"})
_SERVICES = {"domain": 53, "mdns": 5353, "ntp": 123, "snmp": 161, "syslog": 514}
_MOST_JUMPS = 16
_WORD = re.compile(r'"[^"]*"|\{[^}]*\}|[^\s;]+')
_OPTIONS = {  # of iptables: the criterion of nft
    **dict.fromkeys(("-p", "--protocol", "--proto"), "protocol"),
    **dict.fromkeys(("--dport", "--dports", "--destination-port", "--destination-ports"), "port"),
    **dict.fromkeys(("--ports", "--port"), "port"),
    **dict.fromkeys(("-d", "--destination", "--dst"), "to"),
    **dict.fromkeys(("-i", "--in-interface"), "input"),
    **dict.fromkeys(("-o", "--out-interface"), "output"),
    **dict.fromkeys(("--state", "--ctstate"), "state"),
    **dict.fromkeys(("--pkt-type", "--dst-type"), "kind"),
}
_NFT = (  # the words of a criterion, and which it is
    (("ip", "protocol"), "protocol"),
    (("meta", "l4proto"), "protocol"),
    (("udp", "dport"), "port"),
    (("th", "dport"), "port"),
    (("ip", "daddr"), "to"),
    (("ct", "state"), "state"),
    (("pkttype",), "kind"),
    (("fib", "daddr", "type"), "kind"),
    (("iifname",), "input"),
    (("iif",), "input"),
    (("oifname",), "output"),
    (("oif",), "output"),
    (("nfproto",), "family"),
)
_ELSEWHERE = frozenset({"tcp", "icmp", "icmpv6", "icmpx", "ip6", "igmp", "sctp", "ether", "arp"})
_LIMITING = frozenset(
    {"limit", "saddr", "sport", "mark", "vmap", "map", "quota", "skuid", "hour", "day", "time"}
    | {"length", "dscp", "ttl", "cgroup", "rt", "numgen", "jhash", "ibrname", "obrname", "dynset"}
)
_NEUTRAL = frozenset({"comment", "udp", "conntrack", "state", "multiport", "pkttype", "addrtype"})


class Traffic(NamedTuple):
    """The datagrams of a bus, as a firewall sees them."""

    group: str
    port: int
    interface: str


class _Fit(Enum):  # of a rule and the datagrams of a bus
    NO = 0
    SOME = 1  # it applies to some of them, or it is not understood
    ALL = 2


@dataclass(slots=True)
class _Chain:
    rules: list[tuple[_Fit, str, str]] = field(default_factory=list)  # fit, verdict, target
    base: str = ""  # "input" or "output"
    policy: str = "accept"


def refusing_chain(rules: str, traffic: Traffic) -> str:
    """Return the chain that refuses the datagrams of a bus; "" if none does.

    ``rules`` is the output of nft or iptables-save, and the name is as in that ("inet filter
    input", "INPUT"). Rules about forwarding for others, such as Docker's, do not count.
    """
    chains = _chains(rules, traffic)
    bases = (name for name, chain in chains.items() if chain.base)
    refusing = (n for n in bases if (_outcome(n, chains) or chains[n].policy) == "refuse")
    return next((name.strip() for name in refusing), "")


def _chains(  # noqa: C901 - a branch for each kind of line
    rules: str, traffic: Traffic
) -> dict[str, _Chain]:
    chains: dict[str, _Chain] = {}
    table, current = "", None
    for line in rules.splitlines():
        words = _WORD.findall(line)
        first, second = (*words, "", "")[:2]
        if first == "table":
            table, current = " ".join(words[1:3]), None
        elif first == "chain":
            current = chains.setdefault(f"{table} {second}", _Chain())
        elif first[:1] in ("*", ":"):  # a table of iptables, or a chain of its table
            table = first[1:] if first[:1] == "*" else table
            if first[:1] == ":" and table in ("filter", ""):
                policy = _VERDICTS.get(second.lower(), "accept")
                chains[first[1:]] = _Chain(base=_DIRECTIONS.get(first[1:], ""), policy=policy)
        elif first == "-A" and table in ("filter", ""):
            base = _DIRECTIONS.get(second, "")
            chain = chains.setdefault(second, _Chain(base=base))
            chain.rules.append(_iptables_rule(words[2:], traffic))
        elif first == "type" and current is not None:
            hook, rest = _HOOK.search(line), _POLICY.search(line)
            current.base = hook[1] if hook and table.split()[0] in _FAMILIES else ""
            current.policy = _VERDICTS.get(rest[1], "accept") if rest else "accept"
        elif first == "}":
            current = None
        elif current is not None and words:
            fit, verdict, target = _nft_rule(words, traffic)
            current.rules.append((fit, verdict, f"{table} {target}" if target else ""))
    return chains


def _outcome(name: str, chains: Mapping[str, _Chain], depth: int = 0) -> str:
    """Return "accept" or "refuse" if the rules of a chain decide about the bus; else ""."""
    for fit, verdict, target in chains[name].rules if name in chains else ():
        if fit is not _Fit.ALL or depth > _MOST_JUMPS:
            continue
        found = _outcome(target, chains, depth + 1) if target else verdict
        if found == "return":
            return ""
        if found:
            return found
    return ""


def _iptables_rule(words: Sequence[str], traffic: Traffic) -> tuple[_Fit, str, str]:
    fit, verdict, target = _Fit.ALL, "", ""
    rest, negated = iter(words), False
    for word in rest:
        if word == "!":
            negated = True
            continue
        if word in ("-j", "--jump", "-g", "--goto"):
            name = next(rest, "")
            verdict = _VERDICTS.get(name.lower(), "")
            target = "" if verdict else name
        elif word == "-m":
            fit = fit if next(rest, "") in _NEUTRAL else _least(fit, _Fit.SOME)
        elif criterion := _OPTIONS.get(word):
            fit = _least(fit, _fit(criterion, next(rest, ""), traffic, negated=negated))
        elif word in ("-s", "--source", "--sport", "--sports", "--source-port"):
            fit = _least(fit, _fit("from", next(rest, ""), traffic, negated=negated))
        negated = False
    return fit, verdict, target


def _nft_rule(  # noqa: C901 - a branch for each kind of word
    words: Sequence[str], traffic: Traffic
) -> tuple[_Fit, str, str]:
    fit, verdict, target, at = _Fit.ALL, "", "", 0
    while at < len(words):
        word = words[at]
        criterion, length = _nft_criterion(words, at)
        if criterion:
            negated = words[at + length : at + length + 1] == ["!="]
            at += length + negated + (words[at + length : at + length + 1] == ["=="])
            value = (*words[at:], "")[0]
            if value == "vmap":
                return _Fit.SOME, "", ""
            fit = _least(fit, _fit(criterion, value, traffic, negated=negated))
            while value.endswith(",") or words[at + 1 : at + 2] == [","]:  # established, related
                at += 1
                value = (*words[at:], "")[0]
        elif word in _ELSEWHERE and not verdict:
            fit = _Fit.NO
        elif word in _LIMITING and not verdict:
            fit = _least(fit, _Fit.SOME)
        elif word in _JUMPS:
            at += 1
            target = (*words[at:], "")[0]
        elif not verdict and not target:
            verdict = _VERDICTS.get(word, "")
        at += 1
    return fit, verdict, target


def _nft_criterion(words: Sequence[str], at: int) -> tuple[str, int]:
    for names, criterion in _NFT:
        if tuple(words[at : at + len(names)]) == names:
            return criterion, len(names)
    return "", 0


def _least(one: _Fit, other: _Fit) -> _Fit:
    return one if one.value <= other.value else other


def _fit(criterion: str, value: str, traffic: Traffic, *, negated: bool) -> _Fit:
    """Return whether a criterion with this value applies to the datagrams of a bus."""
    if value.startswith("@") or value in ("0.0.0.0/0", ""):  # a named set, which is elsewhere
        return _Fit.SOME if value.startswith("@") else _Fit.NO if negated else _Fit.ALL
    if criterion == "from":
        return _Fit.SOME
    parts = [part.strip('" ') for part in value.strip("{} ").split(",")]
    applies = any(_applies(criterion, part, traffic) for part in parts if part)
    return _Fit.ALL if applies != negated else _Fit.NO


def _applies(  # noqa: PLR0911 - one for each criterion
    criterion: str, value: str, traffic: Traffic
) -> bool:
    match criterion:
        case "protocol":
            return value.lower() in _UDP
        case "port":
            ports = re.split("[-:]", value)
            first, last = (
                _SERVICES.get(one, one) for one in (ports[0] or "0", ports[-1] or "65535")
            )
            return str(first).isdigit() and int(first) <= traffic.port <= int(last)
        case "to":
            return any(IPv4Address(traffic.group) in one for one in _networks(value))
        case "input" | "output":
            name = value.rstrip("+*")
            return traffic.interface == value or (
                name != value and traffic.interface.startswith(name)
            )
        case "state":
            return value.lower() in ("new", "untracked")
        case "family":
            return value == "ipv4"
        case _:  # the kind of address
            return value.lower() == "multicast"


def _networks(value: str) -> Iterator[IPv4Network | IPv6Network]:
    first, dash, last = value.partition("-")
    try:
        if dash:
            yield from summarize_address_range(IPv4Address(first), IPv4Address(last))
        else:
            yield ip_network(value, strict=False)
    except ValueError:
        return
