"""The families of types beside this file, each as a user's own types."""

from pathlib import Path

import pytest
from fixtures.wire import encode_event

from lcmtools.messages.supply import set_supply
from lcmtools.packages import provide_user_types
from lcmtools.wire.packet import Packet

_HERE = Path(__file__).parent


@pytest.fixture
def family(monkeypatch, tmp_path_factory):
    """``family("lengths")``: make a family's types those of the user; gives their folder."""

    def provide(name):
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(_HERE / name))
        provide_user_types()
        return _HERE / name

    yield provide
    set_supply(None)


@pytest.fixture
def log_of(tmp_path):
    """``log_of("POSE", payload, ...)``: the path of a log with messages on a channel, at 10 Hz."""

    def make(channel, *payloads):
        path = tmp_path / f"{channel}.lcmlog"
        packets = (Packet(channel, one, 10**18 + 10**8 * n) for n, one in enumerate(payloads))
        path.write_bytes(b"".join(encode_event(n, one) for n, one in enumerate(packets)))
        return str(path)

    return make
