"""URLs of Zenoh, and the settings that they make."""

import pytest
from fixtures.says import assert_says

from lcmtools.bus.url import misread_options, parse_url
from lcmtools.bus.zenoh.config import settings_of
from lcmtools.bus.zenoh.url import Address
from lcmtools.errors import InvalidUrl


def _settings(url):
    return dict(settings_of(parse_url(url).place, 0x12345678_00000001))


def test_zenoh_stays_on_this_computer():
    settings = _settings("zenoh://")
    assert settings["mode"] == "peer"
    assert settings["listen/endpoints"] == ["tcp/127.0.0.1:0"]
    assert str(settings["scouting/multicast/interface"]).startswith("lo")
    assert settings["id"] == "6c636d746f6f6c731234567800000001"


def test_zenoh_with_hosts_listens_nowhere():
    settings = _settings("zenoh://robot,10.0.0.2:7448,[::1]:7449")
    assert settings["mode"] == "client"
    assert settings["connect/endpoints"] == [
        *("tcp/robot:7447", "tcp/10.0.0.2:7448", "tcp/[::1]:7449")
    ]
    assert "listen/endpoints" not in settings
    assert settings["scouting/multicast/enabled"] is False


def test_zenoh_listens_where_it_is_told():
    assert _settings("zenoh://?listen=0.0.0.0:7447")["listen/endpoints"] == [
        *("tcp/0.0.0.0:7447", "tcp/127.0.0.1:0")
    ]
    both = _settings("zenoh://robot?listen=10.0.0.1")
    assert both["mode"] == "peer"
    assert both["listen/endpoints"] == ["tcp/10.0.0.1:7447"]
    network = _settings("zenoh://?interface=eth0")
    assert network["listen/endpoints"] == ["tcp/0.0.0.0:0"]
    assert network["scouting/multicast/interface"] == "eth0"


def test_zenoh_group_and_file_and_prefix():
    place = parse_url("zenoh://224.0.0.224:7999?prefix=dimos").place
    assert (place.group, place.hosts, place.keys.prefix) == ("224.0.0.224:7999", (), "dimos")
    assert parse_url("zenoh:///etc/zenoh.json5").place.file == "/etc/zenoh.json5"
    assert parse_url("zenoh://a?listen=b:1").place.listen == Address("b", 1)


@pytest.mark.parametrize(
    ("url", "fault"),
    [
        ("zenoh://host:0", "'0' is not a port"),
        ("zenoh://host:99999", "'99999' is not a port"),
        ("zenoh://a,,b", "'' is not a host and port"),
        ("zenoh://tcp/host:7447", "'tcp/host:7447' is not a host and port"),
        ("zenoh://?listen=", "'' is not a host and port"),
        ("zenoh://?prefix=/lcm", "'/lcm' is not a prefix of Zenoh keys"),
        ("zenoh://?patience=long", "patience=long is not a number of seconds"),
        ("zenoh://?patience=0", "patience=0 is not a number of seconds"),
        ("zenoh://?patience=10000", "patience=10000 is not a number of seconds"),
    ],
)
def test_wrong_zenoh_url_is_explained(url, fault):
    with pytest.raises(InvalidUrl, match="zenoh://") as error:
        parse_url(url)
    assert fault in str(error.value)


def test_zenoh_url_is_written_as_it_was_read():
    for url in ("zenoh://", "zenoh://a:1,b:2?prefix=x&listen=c:3", "zenoh:///a.json5"):
        assert str(parse_url(url)) == url
    (note,) = misread_options(parse_url("zenoh://?prefx=a"))
    assert_says(note, "prefx=a", "no effect", "did you mean prefix?")
