"""LCM URLs: what they mean, what is refused, and which one wins."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.bus.url import (
    BusUrl,
    another_domain,
    choose_url,
    domain_url,
    misread_options,
    parse_url,
)
from lcmtools.errors import InvalidUrl, UsageError


@pytest.mark.parametrize(
    ("text", "provider", "host", "port", "options"),
    [
        ("udpm://", "udpm", "239.255.76.67", 7667, {}),
        ("udpm://?ttl=1", "udpm", "239.255.76.67", 7667, {"ttl": "1"}),
        ("udpm://239.255.76.67:7667", "udpm", "239.255.76.67", 7667, {}),
        ("udpm://239.255.76.67:7667?ttl=0", "udpm", "239.255.76.67", 7667, {"ttl": "0"}),
        ("udpm://224.0.0.1:1", "udpm", "224.0.0.1", 1, {}),
        ("udpm://239.255.255.255:65535", "udpm", "239.255.255.255", 65535, {}),
        ("mpudpm://239.255.76.67:7667?nports=1", "mpudpm", "239.255.76.67", 7667, {"nports": "1"}),
        ("tcpq://", "tcpq", "127.0.0.1", 7700, {}),
        ("tcpq://robot:7701", "tcpq", "robot", 7701, {}),
        ("tcpq://robot", "tcpq", "robot", 7700, {}),
        ("tcpq://:7701", "tcpq", "127.0.0.1", 7701, {}),
        ("memq://", "memq", "", 0, {}),
        ("file:///tmp/a.log?speed=0", "file", "", 0, {"speed": "0"}),
        # several "?" are one list of options, as in liblcm; unknown ones are kept
        (
            "udpm://239.255.76.67:7667?ttl=1?recv_buf_size=9",
            "udpm",
            "239.255.76.67",
            7667,
            {"ttl": "1", "recv_buf_size": "9"},
        ),
        ("udpm://?ttl=1&&colour=red&flag", "udpm", "239.255.76.67", 7667,
         {"ttl": "1", "colour": "red", "flag": ""}),
        ("udpm://?ttl=1&ttl=2", "udpm", "239.255.76.67", 7667, {"ttl": "2"}),
    ],
)  # fmt: skip
def test_a_url_is_read_as_liblcm_reads_it(text, provider, host, port, options):
    url = parse_url(text)
    assert (url.provider, url.host, url.port, url.options) == (provider, host, port, options)


@pytest.mark.parametrize(
    ("text", "what", "hint"),
    [
        ("udpm://239.255.76.67", "the port is missing", "'udpm://239.255.76.67:7667?ttl=0'"),
        ("udpm://239.1.2.3?ttl=1", "the port is missing", "'udpm://239.1.2.3:7667?ttl=0'"),
        ("udpm://239.255.76.67:", "'' is not a port", "1 to 65535"),
        ("udpm://239.255.76.67:0", "'0' is not a port", "1 to 65535"),
        ("udpm://239.255.76.67:70000", "'70000' is not a port", "1 to 65535"),
        ("udpm://239.255.76.67:65536", "'65536' is not a port", "1 to 65535"),
        ("udpm://239.255.76.67:-1", "'-1' is not a port", "1 to 65535"),
        ("udpm://239.255.76.67:http", "'http' is not a port", "1 to 65535"),
        ("udpm://239.255.76.67:\u0667", "is not a port", "1 to 65535"),
        ("udpm://10.0.0.1:7667", "10.0.0.1 is not a multicast address", "224.0.0.0 to 239.255"),
        ("udpm://240.0.0.1:7667", "240.0.0.1 is not a multicast address", "224.0.0.0"),
        ("udpm://robot:7667", "robot is not a multicast address", "224.0.0.0"),
        ("udpm://:7667", "nothing is not a multicast address", "'udpm://239.255.76.67:7667"),
        ("mpudpm://10.0.0.1:7667", "10.0.0.1 is not a multicast address", "mpudpm://239.255"),
        ("tcpq://robot:0", "'0' is not a port", "'tcpq://robot:7700'"),
        ("tcpq://robot:", "'' is not a port", "'tcpq://robot:7700'"),
        ("tcpq://[::1]:7700", "LCM's tcpq has no IPv6", "IPv4 address: 'tcpq://127.0.0.1:7700'"),
        ("tcpq://::1", "LCM's tcpq has no IPv6", "'tcpq://127.0.0.1:7700'"),
        ("tcpq://:x", "'x' is not a port", "'tcpq://127.0.0.1:7700'"),
        ("udmp://", "no LCM provider 'udmp'", "did you mean udpm?"),
        ("UDPM://", "no LCM provider 'UDPM'", "did you mean udpm?"),
        ("tcp://a:1", "no LCM provider 'tcp'", "did you mean tcpq?"),
        ("memq", "no LCM provider 'memq'", "'udpm://239.255.76.67:7667?ttl=0'"),
        ("http://a:1", "no LCM provider 'http'", "'udpm://239.255.76.67:7667?ttl=0'"),
        ("239.255.76.67:7667", "no LCM provider", "'udpm://239.255.76.67:7667?ttl=0'"),
        ("udpm:/239.255.76.67:7667", "no LCM provider", "udpm://"),
        ("", "no LCM provider ''", "'udpm://239.255.76.67:7667?ttl=0'"),
        ("udpm://?ttl=one", "ttl=one is not a number", "udpm://"),
        ("udpm://?ttl=-1", "ttl=-1 is not a number", "udpm://"),
        ("udpm://?ttl", "ttl= is not a number", "udpm://"),
        ("udpm://?recv_buf_size=1M", "recv_buf_size=1M is not a number", "udpm://"),
    ],
)
def test_a_wrong_url_says_what_is_wrong_and_how_it_should_look(text, what, hint):
    with pytest.raises(InvalidUrl) as caught:
        parse_url(text, "LCM_DEFAULT_URL")
    assert caught.value.what.startswith(f"LCM_DEFAULT_URL '{text}'")
    assert what in caught.value.what
    assert hint in caught.value.hint


@pytest.mark.parametrize(
    ("text", "ttl"),
    [("udpm://", 0), ("udpm://?ttl=0", 0), ("udpm://?ttl=3", 3), ("udpm://?ttl=257", 1)],
)
def test_the_ttl_is_what_liblcm_makes_of_it(text, ttl):
    assert parse_url(text).ttl == ttl


@pytest.mark.parametrize(
    "text",
    [
        "udpm://239.255.76.67:7667?ttl=0",
        "udpm://239.255.76.67:7667",
        "tcpq://robot:7701",
        "memq://",
        "file:///tmp/a.log?mode=w",
    ],
)
def test_a_url_is_written_as_it_was_read(text):
    assert str(parse_url(text)) == text


def test_an_abbreviated_url_is_written_in_full():
    assert str(parse_url("udpm://")) == "udpm://239.255.76.67:7667"
    assert str(parse_url("tcpq://")) == "tcpq://127.0.0.1:7700"


def test_an_option_is_added_only_where_it_is_not_given():
    url = parse_url("udpm://?recv_buf_size=1000")
    assert url.with_option("recv_buf_size", "9").options["recv_buf_size"] == "1000"
    assert url.with_option("ttl", "0").options["ttl"] == "0"
    assert "ttl" not in url.options


def test_only_udpm_can_be_tapped():
    assert parse_url("udpm://").is_multicast
    assert not any(parse_url(f"{p}://").is_multicast for p in ("mpudpm", "tcpq", "memq"))


def test_a_domain_is_the_default_group_on_a_port_of_its_own():
    assert domain_url("3") == BusUrl(
        "udpm", "239.255.76.67:7670", {"ttl": "0"}, "239.255.76.67", 7670
    )
    assert domain_url("0").port == 7667
    assert domain_url("232").port == 7899
    assert domain_url("007").port == 7674


@pytest.mark.parametrize("domain", ["233", "-1", "x", "", " 3", "3.0", "\u0663", "1" * 5000])
def test_what_is_no_domain_is_refused(domain):
    with pytest.raises(UsageError, match="is not a domain") as caught:
        domain_url(domain, "--domain")
    assert "0 to 232" in caught.value.hint


_ALL = {"LCM_DEFAULT_URL": "udpm://239.0.0.2:2", "LCMTOOLS_DOMAIN": "4"}


@pytest.mark.parametrize(
    ("url", "domain", "environment", "port", "source"),
    [
        ("udpm://239.0.0.1:1", "3", _ALL, 1, "--lcm-url"),
        (None, "3", _ALL, 7670, "--domain"),
        ("", "3", _ALL, 7670, "--domain"),
        (None, "", _ALL, 2, "LCM_DEFAULT_URL"),
        (None, None, {**_ALL, "LCM_DEFAULT_URL": ""}, 7671, "LCMTOOLS_DOMAIN"),
        (None, None, {"LCMTOOLS_DOMAIN": "4"}, 7671, "LCMTOOLS_DOMAIN"),
        (None, "", {"LCMTOOLS_DOMAIN": "4"}, 7671, "LCMTOOLS_DOMAIN"),
        (None, "0", {"LCMTOOLS_DOMAIN": "4"}, 7667, "--domain"),
        (None, None, {"LCMTOOLS_DOMAIN": "", "LCM_DEFAULT_URL": ""}, 7667, "default"),
        (None, None, {}, 7667, "default"),
    ],
)
def test_the_nearest_word_about_the_bus_wins(url, domain, environment, port, source):
    chosen, said_by = choose_url(url, domain, environment)
    assert (chosen.port, said_by) == (port, source)


@pytest.mark.parametrize(
    ("environment", "error", "source"),
    [
        ({"LCM_DEFAULT_URL": "udpm://239.255.76.67"}, InvalidUrl, "LCM_DEFAULT_URL"),
        ({"LCMTOOLS_DOMAIN": "x"}, UsageError, "LCMTOOLS_DOMAIN"),
    ],
)
def test_a_wrong_environment_is_named(environment, error, source):
    with pytest.raises(error, match=source):
        choose_url(None, None, environment)


@pytest.mark.parametrize("domain", ["0", "1", "2"])
def test_another_domain_is_another_bus(domain):
    url = domain_url(domain)
    assert domain_url(str(another_domain(str(url)))) != url


_GROUP = "239.255.76.67:7667"


@pytest.mark.parametrize(
    ("url", "notes"),
    [
        (f"udpm://{_GROUP}?ttl=1&recv_buf_size=9&transmit_only=true", []),
        (f"udpm://{_GROUP}?tt1=1", ["tt1=1 has no effect; did you mean ttl?"]),
        (f"udpm://{_GROUP}?TTL=1", ["TTL=1 has no effect; did you mean ttl?"]),
        (
            f"udpm://{_GROUP}?x=&nports=2",
            [
                f"{option} has no effect; udpm has the options ttl, recv_buf_size, transmit_only"
                for option in ("x=", "nports=2")
            ],
        ),
        (f"udpm://{_GROUP}?ttl=256", ["ttl=256 is sent as 0; the maximum is 255"]),
        (f"mpudpm://{_GROUP}?ttl=0&nports=2", []),
        (f"mpudpm://{_GROUP}?nport=2", ["nport=2 has no effect; did you mean nports?"]),
        ("tcpq://127.0.0.1:7700?ttl=1", ["ttl=1 has no effect; tcpq has no options"]),
        ("memq://?a=1", ["a=1 has no effect; memq has no options"]),
        ("file:///a.log?speed=0&mode=r&start_timestamp=1", []),
        ("file:///a.log?spee=0", ["spee=0 has no effect; did you mean speed?"]),
        ("zenoh://?patience=2", []),
        ("zenoh://?patient=2", ["patient=2 has no effect; did you mean patience?"]),
    ],
)
def test_options_that_liblcm_does_not_take_are_named(url, notes):
    read = parse_url(url)
    assert list(misread_options(read, "LCM_DEFAULT_URL")) == [
        f"LCM_DEFAULT_URL {read}: {note}" for note in notes
    ]


@given(st.text(max_size=40) | st.text("udpm:/?=&1.9", max_size=40).map("udpm://".__add__))
def test_any_text_is_a_url_or_refused(text):
    try:
        url = parse_url(text)
    except InvalidUrl:
        return
    assert parse_url(str(url)) == parse_url(str(parse_url(str(url))))
    assert 0 <= url.ttl <= 255
