"""The sentences of findings: the one place where a finding, its facts and remedies become text.

In a sentence, ``{name}`` is a part of the statement; backticks enclose a command that can be typed
as it is, and are not shown. Pure.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from string import Formatter
from typing import Any, NamedTuple

from lcmtools.doctor.findings import Finding, Statement, Subject, Unchecked
from lcmtools.observe.measuring.counters import duration_text

TITLES = {
    "bandwidth": "{interface} is too slow for the bus, which carries"
    " {megabytes_per_second:.1f} MB/s:",
    "boot": "Messages are stamped with the time since a start, and nothing publishes /clock:",
    "bus": "The bus does not work: {problem}",
    "clock-ahead": "The clock of {host} ({host.address}) is {seconds:time} ahead of this"
    " computer's:",
    "clock-behind": "The clock of {host} ({host.address}) is {seconds:time} behind this"
    " computer's:",
    "competing-publishers": "{count} programs publish on {topics:and} at the same time:",
    "container": "This is a {container} with its own network, and no other computer is seen",
    "covariance": "Covariances that are published are invalid:",
    "damaged-log": "{bytes} bytes of {log} do not belong to any message",
    "doubled": "Messages of the following come more than once, with the same sequence number:",
    "duplicate-names": "{count} nodes have the name {name}:",
    "environment": "The environment of this shell has errors:",
    "firewall": "The firewall {firewall} is enabled, and no other computer is seen",
    "frame-loop": "The following frames form a loop:",
    "frame-parents": "The following frames have several parents:",
    "future": "Messages are stamped with a time in the future:",
    "igmp-querier": "The bridge {bridge} sends no IGMP queries, and no other computer is seen",
    "interfaces": "The route to the bus leads to {interface}, but programs listen elsewhere:",
    "irregular": "The following come at irregular intervals:",
    "jumping-simulator": "Simulated time jumps back:",
    "kernel-drops": "The following read too slowly, so that the kernel dropped datagrams:",
    "large-messages": "A message of {bytes} bytes does not come back: {problem}",
    "long-names": "The following names are nearly as long as LCM can carry (63 bytes):",
    "link": "The interface {interface}, to which the route to the bus leads, has no link: nothing"
    " leaves this computer",
    "loopback-route": "ttl={ttl}, but the route to the bus leads to lo: no other computer"
    " receives anything",
    "callback-errors": "Callbacks of the following raise exceptions:",
    "logged": "The following nodes log warnings or errors:",
    "loss": "Messages of the following senders were lost:",
    "malformed": "The following senders put datagrams on the bus that are not LCM's:",
    "mpudpm": "The following programs use mpudpm, which is not the udpm of this bus:",
    "no-clock": "The following nodes use simulated time, and nothing publishes {topic}:",
    "no-lcm-messages": "The following are not LCM messages:",
    "no-traffic": "There are no nodes on {bus}, and nothing came in {listened:g} s",
    "not-finite": "Numbers that are published are not finite:",
    "nsec": "Times that are published are invalid:",
    "old": "Messages are stamped with a time long ago:",
    "open-files": "The following programs have nearly as many files open as LCM can handle:",
    "other-buses": "The following programs of yours are on other buses{topics:with}{awaited:wait}:",
    "other-users": "Other users of this computer share this bus:",
    "paused-simulator": "Simulated time stands still:",
    "overloaded-simulator": "Simulated time passes at {ratio:.2f} of real time{target:not}:"
    " the simulator is overloaded",
    "quaternion": "Rotations that are published are invalid:",
    "queue-drops": "The following nodes are too slow for the messages they receive:",
    "never-called": "The following nodes do not run their callbacks:",
    "reassembly": "{datagrams} datagrams came without some of their fragments",
    "relay-bus": "The following relays do not reach one of their buses:",
    "relay-commands": "Commands do not pass a relay, and a node behind it waits for them:",
    "relay-losses": "The following relays drop messages:",
    "relay-standby": "The following relays stand by, because others join the same buses:",
    "rp-filter": "rp_filter is strict on {interface}: it may drop other computers' messages",
    "replayed": "Stamps are old but advance at the clock's rate, as if a log were played:",
    "rp-filter-drops": "rp_filter dropped {datagrams} datagrams that came in on another interface"
    " than the one that leads to their senders",
    "sending": "Messages cannot leave this computer: {problem}",
    "services": "The following services are offered by more than one node, and each executes a"
    " request:",
    "silent": "The following have stopped publishing:",
    "similar-names": "The following channels look the same, but differ:",
    "slow-callbacks": "The following callbacks take too long:",
    "slow-rate": "The following have become slower:",
    "slow-simulator": "Simulated time passes at {ratio:.2f} of real time{target:not}",
    "small-buffer": "{topic} from {sender} has {bytes} bytes, too many for the receive buffers of:",
    "stale-nodes": "The following nodes do not answer any more:",
    "stopped-programs": "The following programs are stopped: they send and receive nothing:",
    "stuck-listeners": "The following are subscribed, but do not read:",
    "ttl-0": "Other computers ({hosts:list}) cannot receive from the following (ttl=0):",
    "ttl-far": "The following let routers forward their messages to other networks:",
    "type-mismatch": "The types on {topic} do not match:",
    "type-names-differ": "The types on {topic} have the same fields, but different names:",
    "unconnected-publications": "The following node publications have no announced subscriber:",
    "unconnected-subscriptions": "The following node subscriptions are unconnected:",
    "unconnected-clients": "The following call services that no node offers:",
    "undecodable": "Messages cannot be decoded:",
    "types-without-file": "The types of the following are not known here:",
    "unit": "Times that are published are in the wrong unit:",
    "unknown-type": "The types of the following are similar to known ones:",
    "unusable-names": "The following channels have names that few programs can subscribe to:",
}
_MOST = 8  # names in a row
_PACE = "its callback takes {callback_time:time}, messages come every {interval:time}"
_HANGS = "a call of its callback has not ended for {seconds:time}"
_LOST = "{node} lost {lost} messages of {topic} (depth {depth})"
_SENT = "{lost} of {sent} ({percent:.1f} %)"
FACTS = {
    "buffer": "{listener}: {buffer_bytes:holds}",
    "busy-node": "{node} is in its callbacks {percent:.0f} % of the time, mostly in {busiest:work}",
    "bytes-wait": "{listener}: {queued_bytes} bytes are waiting",
    "calls": "{node} calls {service}",
    "channel": "{topic} from {sender}",
    "doubled": "{sender}: {count} messages",
    "dropped": "{listener}: {drops}, its receive buffer {buffer_bytes:holds}",
    "dropped-by-busy-node": f"{_LOST}: its node is in {{busiest:work}} most of the time",
    "dropped-by-queue": _LOST,
    "dropped-hanging": f"{_LOST}: {_HANGS}",
    "dropped-held-up": f"{_LOST}: its node was in {{busiest:work}} for {{seconds:time}} meanwhile",
    "dropped-in-bursts": f"{_LOST}: they come in bursts",
    "dropped-long-call": f"{_LOST}: a call of its callback took {{seconds:time}}",
    "dropped-slow-callback": f"{_LOST}: {_PACE}",
    "dropped-without-spin": f"{_LOST}: no callback has run",
    "expects": "{node} expects {type}",
    "firewall-enabled": "the firewall {firewall} is enabled",
    "frame-loop": "{frames}, from {senders:and}",
    "frame-parents": "{frame} is in {parents:and}",
    "gap": "{sender}: {topic}, {longest:.2f} s without a message, usually {usual:time}",
    "hanging-callback": f"{{node}}, {{topic}}: {_HANGS}",
    "in-container": "this is a {container}, which may not forward multicast",
    "interface-down": "the interface {interface} is down",
    "jumps-back": "{program}: {count:times}",
    "joined-on": "on {interface}",
    "listens": "{listener} listens",
    "listens-on": "{listener}: on {interfaces:and}",
    "logged": "{node}: {level}: {text}{messages:count}",
    "lost-in-sender": f"{{sender:called}}: {_SENT} before they left it",
    "lost-on-network": f"{{sender:called}}: {_SENT} on the network",
    "may-be-late": "this computer is too busy to tell: they may only be late",
    "may-publish": "{process} (pid {process.pid}) uses LCM, and may publish rarely",
    "more": "and {count} more",
    "no-link": "the interface {interface} has no link",
    "no-multicast-flag": "the interface {interface} has no multicast flag",
    "node-pid": "{node} (pid {pid})",
    "node-process": "pid {pid} on {host}: {command}",
    "node-topics": "{node}:",
    "odd-channel": "{topic:repr} from {sender}: {reason}",
    "odd-type": "the odd one is {senders:and}: {programs:and} {programs:use} {types:or}",
    "offered": "{service}: {nodes:and}",
    "oddity": "{topic} from {sender}: {text}{messages:count}",
    "older-type": "the older version is probably that of {senders:and}",
    "on-bus": "pid {process.pid} on {bus}{variable:brackets}: {process}",
    "on-bus-by-code": "pid {process.pid} probably on {bus} (its code names it): {process}",
    "open-files": "pid {process.pid} has {open_files} files open, of {most_files}: {process}",
    "process": "{process} (pid {process.pid})",
    "program": "{program}",
    "publisher": "{sender}: {topic}",
    "publishes": "{node} publishes {type}",
    "raised": "{node} raised {exception} {count:times}, {place}: {message} (in {callback:call})",
    "received": "{node} has received {messages} messages of {topic}",
    "relay-bus": "{relay} on {host}: {trouble}",
    "relay-command": "{topic}, at {relay} on {host}",
    "relay-dropped": "{relay} on {host}: {count} messages for {bus}",
    "relay-standby": "{relay} on {host}",
    "repeats": "{sender}: {topic}, {count} messages that another sender had sent before",
    "sender-reason": "{sender}: {reason}",
    "sends": "{sender} sends {type}",
    "sends-with-ttl": "{sender} sends with ttl={ttl}",
    "silent-node": "{publisher}: {topic}, {seconds:.0f} s ago, {rate:.3g} Hz before",
    "silent-stream": "{publisher}: {topic}, {seconds:.1f} s ago, {rate:.3g} Hz before",
    "slow-callback": f"{{node}}, {{topic}}: {_PACE}",
    "slower": "{node}: {topic}, {rate:.3g} Hz instead of {usual:.3g} Hz",
    "slower-program": "{sender}: {rate:.3g} Hz in all, and {usual:.3g} Hz on average since its"
    " start",
    "slower-stream": "{sender}: {topic}, {rate:.3g} Hz instead of {usual:.3g} Hz",
    "stale": "{node} (pid {pid}): {why}",
    "stale-elsewhere": "{node} (pid {pid} on {host:at}): {why}",
    "stopped": "{listener}: it is stopped",
    "stream-bandwidth": "{topic} from {sender}: {megabytes_per_second:.2f} MB/s",
    "switch-forgets": "if messages stop some minutes after a start, a switch has forgotten the"
    " members of the group",
    "text": "{text}",
    "two-channels": "{topic:repr} from {sender}, and {other_topic:repr} from {other_sender}",
    "unknown-type": "{topic} from {senders:and}: {type}",
    "user-programs": "{user}: {programs:list}",
}
_LCM_GEN = "generate the code of both sides from the same .lcm files: lcm-gen"
REMEDIES = {
    "allow-by-firewalld": "`sudo firewall-cmd --add-rich-rule='rule family=ipv4 destination"
    " address=224.0.0.0/4 accept'`",
    "allow-by-iptables": "`sudo iptables -I {chain} -d 224.0.0.0/4 -j ACCEPT`",
    "allow-by-nftables": "`sudo nft insert rule {chain} ip daddr 224.0.0.0/4 accept`",
    "allow-by-ufw": "`sudo ufw allow in proto udp to 224.0.0.0/4`",
    "allow-command": "if they should pass: start {relay} with --allow {topic} (and --allow '**', if"
    " it has no other); else with --deny {topic}",
    "busiest-less": "let {busiest:work} of {node} do less, and never wait",
    "callback-less": "let the callback of {topic} do less",
    "callback-less-or-depth": "let the callback of {topic} do less, or increase the queue depth",
    "callback-less-or-rate": "let the callback of {topic} do less, or publish it only"
    " every {seconds:time}",
    "carry-less": "let it carry less, for example of images: --rate '/camera/**=5' --newest"
    " '/camera/**', or --deny",
    "change-type": "{publisher} publishes {topic}, but as {type}, and {node} expects {expected}",
    "close-files": "close unneeded files, or restart the programs; a limit above 1024 does not"
    " help, because liblcm waits with select",
    "compare-buses": "if it runs already, it may be on another bus: compare LCM_DEFAULT_URL and"
    " LCMTOOLS_DOMAIN in both shells",
    "compare-clocks": "compare them: `chronyc tracking`, or `timedatectl timesync-status`",
    "connect": "plug its cable in, or connect its Wi-Fi",
    "correct": "correct {place}, and start {node} again",
    "depth": "increase the queue depth of the subscription of {topic}",
    "drop-remap": "start {node} without {argument}",
    "encode-by-lcm": "if that is not intended, describe them in a .lcm file, and encode them with"
    " the code that lcm-gen generates",
    "enable-querier": "`echo 1 | sudo tee /sys/class/net/{bridge}/bridge/multicast_querier`",
    "end-one-or-part": "end one of them{pids:kills}, or start {other} on another bus",
    "end-one-or-remap": "end one of them{pids:kills}, or start {other} with {old}:={new}",
    "end-one-or-rename": "end one of them{pids:kills}, or let it publish on another channel",
    "end-standby": "if it should not take over from the other one: `lcmtools node kill {relay}`",
    "end-or-rename": "end one of them{pids:kills}, or start it with __name:={name}",
    "expects-as": "let {program} subscribe to {topic} as {types:or}",
    "correct-file": "correct the file that cannot be read: {problem}",
    "correct-environment": "correct the variable in this shell and in ~/.bashrc; keep only one"
    " package: pip uninstall, pip install lcm",
    "exchange-frames": "header.frame_id is the parent, child_frame_id the child: swap them in one"
    " of the transforms",
    "export": "`export {variable}='{value}'`",
    "find-second-way": "look for a second path to this computer: a loop of cables or bridges, two"
    " interfaces on one network, a mirroring port; or a sender that sends everything twice",
    "fix-log": "`lcmtools bag fix {log} fixed.lcmlog` leaves them out",
    "host-network": "start the container with: --network host",
    "if-no-log": "if it is not a log, its computer's clock is wrong:"
    " `sudo timedatectl set-ntp true`",
    "inspect": "see what it does: `sudo gdb -p {pid}`",
    "inspect-java": "see what it does: `jstack {pid}`",
    "inspect-python": "see what it does: `sudo py-spy dump --pid {pid}`",
    "join-here": "if they should be on this one, start them with {variable}='{value}'",
    "look-at-firewall": "see whether a firewall drops large datagrams: `sudo nft list ruleset`",
    "look-there": "check there whether the network and the node work: `lcmtools wtf`",
    "macos-large-datagrams": "macOS: `sudo sysctl -w net.inet.udp.maxdgram=65535`",
    "mend-bus": "{hint}",
    "microseconds": "message.utime = time.time_ns() // 1000",
    "mend-line": "start the bus that the relay joins, or repair the connection; the relay retries",
    "mirrored-network": "write networkingMode=mirrored under [wsl2] into %UserProfile%\\.wslconfig",
    "namespace": "start {node} with __ns:={namespace}",
    "never-wait-or-depth": "let the callback of {topic} never wait, or increase the queue depth",
    "name-here": "those without a variable get their bus from their code or arguments: name this"
    " bus there, or none: lcm.LCM()",
    "normalise": "for no rotation use x=0, y=0, z=0, w=1; divide others by their length",
    "one-parent": "let one program publish the pose of a frame, in one header.frame_id, or give the"
    " frames of different things different names",
    "open-circle": "a program that forwards what it receives creates a loop if that comes back to"
    " it: let it publish on another channel",
    "own-domain": "use a bus of your own: `export {variable}={value}` (a number up to 232)",
    "plain-name": "use a name of letters, digits, _ and / only",
    "print-values": "print the values where the node computes them",
    "publishes-as": "let {program} publish {topic} as {types:or}",
    "read-log": "read the whole log: `lcmtools echo /rosout`",
    "remap": "start {node} with {old}:={new}",
    "remap-one": "remap one of them to another topic, for example {topic}:={topic}_2",
    "remove-slash": "let {node} use '{name}' in place of '{topic}': the slash at its start keeps it"
    " out of the namespace {namespace}",
    "rename-one": "let one of them use another channel",
    "replace-remap": "start {node} with {old}:={new} in place of {argument}",
    "republish": "let it publish on '{topic}'",
    "resume": "if that was not intended: `lcmtools sim resume`",
    "restart-listeners": "restart the listeners, or set the route to their interface:"
    " `ip route show 224.0.0.0/4`",
    "restart-or-forget": "start {node} again, or forget it: `lcmtools node cleanup`",
    "route": "if they should: `sudo ip route replace 224.0.0.0/4 dev eth0` (with your interface)",
    "route-to": "or set the route to another interface:"
    " `sudo ip route replace 224.0.0.0/4 dev {interface}`",
    "same-lcm-files": _LCM_GEN,
    "same-name": "publish both under the same name",
    "same-type": "it works; declare the same type on both sides, so that all commands show the"
    " same",
    "sends-as": "let {program} send {types:or} on {topic}",
    "send-elsewhere": "let them send elsewhere, or end them; their ports and programs: `ss -uanp`",
    "send-less": "send less or smaller messages; a large one is lost with any of its parts",
    "set-clocks": "synchronize both computers' clocks: `sudo timedatectl set-ntp true`",
    "set-rate": "if that was not intended: `lcmtools sim set-rate {rate:g}`",
    "shorter-name": "use a shorter name",
    "simulate-less": "end programs that subscribe to cameras, or give it fewer robots",
    "smaller-messages": "send smaller messages",
    "spin": "let {node} spin: lcmtools.spin(node), or spin_once often",
    "split-time": "sec, nsec = divmod(time.time_ns(), 1_000_000_000)",
    "stamp-if-no-log": "if it is not a log, stamp with the time at which it is sent",
    "stamp-utc": "stamp with the time since 1970: time.time(), node.get_clock().now()",
    "start-it-with-variable": "start it with {variable}='{value}'",
    "start-publisher": "start a publisher of {topics:and}; to see what is published:"
    " `lcmtools list -v`",
    "start-server": "start a node that offers {service}; to see what is offered:"
    " `lcmtools service list`",
    "start-simulator": "or start the simulator, for example: `lcmtools run sim`",
    "start-something": "start something, for example: `lcmtools run talker`",
    "start-with-variable": "start them with {variable}='{value}'",
    "subscribe-to-pattern": "or subscribe to the pattern {pattern}",
    "symmetric": "set [row, column] and [column, row] to the same value, and no [row, row] below 0",
    "sysctl": "`sudo sysctl -w {name}={value}`",
    "time-rises": "unless it was a reset, or a log that is played again: publish on /clock a time"
    " that only rises",
    "ttl-1-is-enough": "ttl=1 is enough for the computers of one network",
    "unknown-covariance": "if nothing is known, set the first number to -1",
    "type-path": "name the folder of their .lcm files: export LCMTOOLS_TYPE_PATH=FOLDER",
    "use-lcm-gen": "let the sender use lcm-gen's code, unchanged",
    "use-server": "or connect both by a server: LCM_DEFAULT_URL=tcpq://HOST:7700",
    "use-sim-time": "if a simulator runs, start the node with _use_sim_time:=true",
    "use-ttl-0": "keep what only this computer needs on a bus with ttl=0",
    "use-ttl-1": "start them with ?ttl=1 in the URL, for example: {url}",
    "wake-or-end": "wake it (`kill -CONT {pid}`) or end it (`kill -KILL {pid}`)",
}
REASONS = {
    "no-subscriber": "{channel} of the same type has no subscriber",
    "offered": "{channel} is offered",
    "published": "{channel} is published",
    "publishes": "{publisher} publishes {channel}",
    "same-type": "{channel} is of the same type",
    "subscribes": "{listener} subscribes to {channel}",
}
UNCHECKED = {
    "bandwidth-unknown": "{interface} reports no speed",
    "buffers-unknown": "this system does not report the size of the listeners' buffers",
    "hidden-programs": "programs of other users ({users:list}) are hidden from you: sudo lcmtools"
    " wtf shows them",
    "zenoh-losses": "wtf does not count losses on Zenoh; lcmtools hz TOPIC does",
    "no-senders": "on {provider}, wtf cannot see senders and losses",
    "no-network": "this system does not report its routes and interfaces (it has no /proc/net)",
    "no-processes": "this system does not report the sockets of programs (it has no /proc)",
    "no-sockets": "this system does not list its sockets (it has no /proc/net/udp)",
    "text": "{text}",
}


class Description(NamedTuple):
    """A finding in words: a line, lines to show below it, and what to type or change."""

    title: str
    items: tuple[str, ...]
    remedies: tuple[str, ...]


def describe(finding: Finding) -> Description:
    """Put a finding into words."""
    return Description(
        _fill(TITLES[finding.title.kind], finding.title.parts),
        tuple(line for fact in finding.facts for line in fact_lines(fact)),
        tuple(map(remedy_text, finding.remedies)),
    )


def remedy_text(remedy: Statement) -> str:
    """A remedy in words, with its reason."""
    text = _fill(REMEDIES[remedy.kind].replace("`", ""), remedy.parts)
    parts: dict[str, Any] = dict(remedy.parts)
    if more := parts.get("or"):
        text += f" (or {', '.join(f'__ns:={name}' for name in more)})"
    if "or_publish_on" in parts:
        text = f"let it publish on '{parts['or_publish_on']}', or {text}"
    if "because" not in parts:
        return text
    if parts["because"] == "published" and remedy.kind == "republish":
        parts["channel"] = f"'{parts['channel']}'"  # spaces may be the fault
    by = f", by {parts['by']}" if "by" in parts else ""
    return f"{_fill(REASONS[str(parts['because'])], parts)}{by}: {text}"


def commands(remedy: Statement) -> list[str]:
    """The commands in a remedy that can be typed as they are."""
    if remedy.kind == "mend-bus":
        hint = str(remedy.parts["hint"])
        command = hint if hint.startswith("export ") else hint.partition("type: ")[2]
        return [command] if command else []
    pids = remedy.parts.get("pids")
    if isinstance(pids, tuple):
        return [f"kill {pid}" for pid in pids]
    return [_fill(command, remedy.parts) for command in REMEDIES[remedy.kind].split("`")[1::2]]


def unchecked_text(unchecked: Unchecked) -> str:
    """The reason why something could not be looked at."""
    return _fill(UNCHECKED[unchecked.reason.kind], unchecked.reason.parts)


def fact_lines(fact: Statement) -> Iterator[str]:
    """A fact in words: a line, and perhaps further ones below it."""
    yield f" * {_fill(FACTS[fact.kind], {**fact.parts, 'type': _type(fact)})}"
    if fact.kind == "node-topics":  # as roswtf lists them: a node, and its topics below it
        yield from (f"   * {topic}" for topic in fact.subjects() if topic.kind == "topic")


def _type(fact: Statement) -> str:
    """The type of messages that a fact is about, as far as it is known."""
    if "types" in fact.parts:
        return _fill("{types:or}", fact.parts)
    if "format" in fact.parts:
        return str(fact.parts["format"])
    if "fingerprint" not in fact.parts:
        return "data that is not an LCM message"
    near = ": like {like}, but {difference}" if "like" in fact.parts else ""
    name = "{name}" if "name" in fact.parts else "an unknown type"
    return _fill(f"{name} ({{fingerprint}}{near})", fact.parts)


def _first(values: Sequence[object]) -> list[str]:
    """The first of many values, and the number of the others."""
    more = [f"{len(values) - _MOST + 1} more"] if len(values) > _MOST else []
    return [*map(_shown, values[: _MOST - len(more)]), *more]


def _shown(value: object) -> str:
    """A name as it is shown: channels that are no topics of nodes in quotes."""
    is_plain = isinstance(value, Subject) and value.kind == "topic" and value.name[:1] != "/"
    return _quoted(value) if is_plain else str(value)


def _quoted(value: object) -> str:
    """A name in quotes, as Python writes it; a byte that is no UTF-8 as it is elsewhere."""
    return re.sub(r"\\udc(?=[89a-f])", r"\\x", repr(str(value)))


_SPECS: Mapping[str, Callable[[Any], str]] = {
    "and": lambda values: " and ".join(_first(values)),
    "at": lambda host: f"{host} at {host.address}" if host.address else str(host),
    "brackets": lambda text: f" ({text})" if text else "",
    "called": lambda sender: (
        str(sender) if str(sender) == sender.address else f"{sender} ({sender.address})"
    ),
    "count": lambda messages: f" ({messages} messages)" if messages > 1 else "",
    "holds": lambda size: f"holds {size} bytes" if size else "is too small",
    "kills": lambda pids: " " + " or ".join(f"(kill {pid})" for pid in pids) if pids else "",
    "list": lambda values: ", ".join(_first(values)),
    "not": lambda target: f", not {target:g}" if target != 1 else "",
    "or": lambda values: " or ".join(map(str, values)),
    "call": lambda name: f"the callback of {name}" if str(name).startswith("/") else str(name),
    "repr": _quoted,
    "times": lambda count: f"{count} times" if count > 1 else "once",
    "use": lambda several: "uses" if len(several) == 1 else "use",
    "time": lambda seconds: duration_text(seconds * 1e9),
    "with": lambda topics: (
        f", with {' and '.join(_first(topics))}, which nodes here wait for" if topics else ""
    ),
    "wait": lambda topics: (
        f", and wait there for {' and '.join(_first(topics))}, which is published here"
        if topics
        else ""
    ),
    "work": lambda name: "the timers" if name == "timers" else f"the callback of {name}",
}
"""The ways to show a part that ``format`` does not have."""


class _Sentence(Formatter):
    def format_field(self, value: object, format_spec: str) -> str:
        if isinstance(value, Subject) and not format_spec:
            return _shown(value)
        special = _SPECS.get(format_spec)
        return special(value) if special else str(super().format_field(value, format_spec))


def _fill(sentence: str, parts: Mapping[str, object]) -> str:
    return _Sentence().vformat(sentence, (), parts)
