"""Opening a Zenoh session, and what to do if that fails.

When a session opens, it knows only the first of the others; this waits until no more appear.
"""

import json
import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from lcmtools.bus.preflight import check_bus
from lcmtools.bus.url import BusUrl
from lcmtools.bus.zenoh.check import check_place, refusal
from lcmtools.bus.zenoh.config import settings_of
from lcmtools.bus.zenoh.url import Address, locator_address
from lcmtools.errors import BusError, needing_extra
from lcmtools.folders import read_bytes

with needing_extra("zenoh", "a Zenoh bus needs"):
    import zenoh as zenoh  # noqa: PLC0414 - for ``session``, which needs it as well

ItemT = TypeVar("ItemT")
_IMPORTED_BY = os.getpid()
_TLS = ("listen_private_key", "listen_certificate", "connect_private_key", "connect_certificate")
_FILES = (
    "auth/usrpwd/dictionary_file",
    *(f"link/tls/{name}" for name in ("root_ca_certificate", *_TLS)),
)
"""The files that a configuration names."""
_STILL, _SETTLED = 0.05, 0.5  # [s] to wait after the last program that appears; at most in all
_CODE_PLACE = re.compile(r" at /\S+\.rs:\d+\.?")
_JSON_FAULT = re.compile(r'msg: "(?P<text>.*?)", location.*line: (?P<line>\d+)', re.DOTALL)
_SYNTAX_FAULT = re.compile(r"--> (?P<line>\d+):.*= (?P<text>.*)", re.DOTALL)


def open_session(url: BusUrl, identifier: int) -> tuple[zenoh.Session, bool]:
    """Return a new session, and whether all its messages go through one router or program.

    Raises:
        BusError: The bus cannot be reached; the error says what to do.
    """
    if os.getpid() != _IMPORTED_BY:
        what = "Zenoh does not work in a process that was forked from one that uses it"
        hint = "start it by subprocess, or by multiprocessing with the method 'spawn'"
        raise BusError(what, hint)
    check_bus(url)
    config = _config(url, identifier)
    _check_files(config)
    is_client = json.loads(config.get_json("mode")) == "client"
    try:
        session = zenoh.open(config)
    except zenoh.ZError as error:
        raise _fault(url, config, error, is_client=is_client) from error
    if not is_client:
        _await_others(session)
    return session, is_client


def reason_of(error: Exception) -> str:
    """Return Zenoh's own words as one line, without places in its code."""
    text = _CODE_PLACE.sub("", str(error))
    if fault := _JSON_FAULT.search(text) or _SYNTAX_FAULT.search(text):
        text = f"line {fault['line']}: {fault['text']}"
    return " ".join(text.partition(", expected one of")[0].split())


def direct(callback: Callable[[ItemT], None]) -> "zenoh.handlers.Callback[ItemT]":
    """Return a handler that is called on Zenoh's own thread, without another queue and thread."""
    return zenoh.handlers.Callback(callback, indirect=False)


def _config(url: BusUrl, identifier: int) -> zenoh.Config:
    place = url.place
    try:
        config = zenoh.Config.from_file(place.file) if place.file else zenoh.Config()
        for name, value in settings_of(place, identifier).items():
            config.insert_json5(name, json.dumps(value))
    except zenoh.ZError as error:
        what = f"cannot use {place.file or url}: {reason_of(error)}"
        raise BusError(what, "docs/networks.md shows a configuration file of Zenoh") from error
    return config


def _check_files(config: zenoh.Config) -> None:
    """Refuse devices, pipes and large files, which Zenoh would read without end."""
    for name in _FILES:
        file = json.loads(config.get_json(f"transport/{name}"))
        if file and Path(file).exists():
            what = f"cannot read '{file}', {name} of Zenoh's configuration"
            read_bytes(Path(file), what=what, kind=BusError)


def _fault(url: BusUrl, config: zenoh.Config, error: Exception, *, is_client: bool) -> BusError:
    """Return the error to raise in place of Zenoh's, which says little."""
    if not is_client:
        return BusError(f"Zenoh cannot open {url}: {reason_of(error)}")
    address = _host_of(config)
    if address is None:
        hint = f"'connect' in {url.place.file} may name one"
        return BusError("no Zenoh router is found", hint)
    try:
        check_place(url.place._replace(file="", hosts=(address,)))
        return refusal(address, *_login_of(config))
    except BusError as known:
        return known


def _host_of(config: zenoh.Config) -> Address | None:
    """Return the first host of a client's configuration."""
    found = json.loads(config.get_json("connect/endpoints"))
    endpoints = found.get("client", []) if isinstance(found, dict) else found
    return locator_address(str(endpoints[0])) if endpoints else None


def _login_of(config: zenoh.Config) -> tuple[str, str | None]:
    """Return the user in a configuration and, if it uses TLS, its certificates."""
    user = json.loads(config.get_json("transport/auth/usrpwd/user"))
    if '"tls/' not in config.get_json("connect/endpoints"):
        return user or "", None
    trusted = json.loads(config.get_json("transport/link/tls/root_ca_certificate"))
    return user or "", trusted or ""


def _await_others(session: zenoh.Session) -> None:
    """Wait until no more programs appear: the first one reports the others."""
    start = changed = time.monotonic()
    known = 0
    while (now := time.monotonic()) - changed < _STILL and now - start < _SETTLED:
        if (count := len(session.info.peers_zid())) != known:
            known, changed = count, now
        if not known:
            return  # no other programs: opening has already waited for them
        time.sleep(0.002)
