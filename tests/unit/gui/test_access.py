"""Who may open a page, and what it may do."""

import re

import pytest
from fixtures.says import assert_says

from lcmtools.gui.access import HEADERS, Refused, access_for

HERE = "127.0.0.1:7680"
OWN = access_for(None)


def refusal(access, host, target="/"):
    with pytest.raises(Refused) as caught:
        access.rights(host, target)
    return caught.value.reason


@pytest.mark.parametrize("host", [HERE, "localhost:7680", "LOCALHOST:8000", "[::1]:7680"])
def test_this_computers_names_are_answered_behind_any_port(host):
    assert OWN.rights(host, "/") == ("watch", "command")


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1.evil.example", "192.168.1.20:7680", "", "[", "a@localhost"]
)
def test_another_name_that_leads_here_is_refused(host):
    if host == "a@localhost":  # a header Host has no user: only the name counts
        assert OWN.rights(host, "/")
        return
    assert_says(refusal(OWN, host), "not answer", "name")


@pytest.mark.parametrize(
    "origin",
    [
        None,
        "null",
        "http://evil.example",
        "http://127.0.0.1:9000",
        "http://localhost:7680",
        "http://127.0.0.1:7680.evil.example",
    ],
)
def test_a_page_of_another_server_is_refused(origin):
    with pytest.raises(Refused, match="its own pages only"):
        OWN.check_origin(HERE, origin)


def test_its_own_page_is_let_in_also_through_a_tunnel():
    OWN.check_origin(HERE, f"http://{HERE}")
    OWN.check_origin("localhost:9999", "http://localhost:9999")


def test_others_need_a_token_and_watching_is_not_commanding():
    access = access_for("192.168.1.20")
    addresses = access.addresses("192.168.1.20", 7680)
    assert list(addresses) == ["watch", "command"]
    targets = {right: address.partition("7680")[2] for right, address in addresses.items()}
    assert access.rights("192.168.1.20:7680", targets["watch"]) == ("watch",)
    assert access.rights("192.168.1.20:7680", targets["command"]) == ("watch", "command")
    for target in ("/", "/?token=", "/?token=x", "/?other=1"):
        assert "needs the token" in refusal(access, "192.168.1.20:7680", target)
        assert "needs the token" in refusal(access, HERE, target)
    assert len({*targets.values()}) == 2
    assert all(re.fullmatch(r"/\?token=[\w-]{22}", target) for target in targets.values())


@pytest.mark.parametrize(("is_read_only", "right"), [(False, "command"), (True, "watch")])
def test_other_users_of_this_computer_need_the_token_too(*, is_read_only, right):
    access = access_for(None, is_read_only=is_read_only, own_token=lambda right: f"my-{right}")
    assert access.addresses("127.0.0.1", 7680) == {right: f"http://{HERE}/?token=my-{right}"}
    assert right in access.rights(HERE, f"/socket?token=my-{right}")
    assert access.rights(HERE, f"/?token=my-{right}") == OWN.rights(HERE, "/")[: 2 - is_read_only]
    for target in ("/", "/?token=", "/socket?token=x"):
        assert "needs the token" in refusal(access, HERE, target)


def test_tokens_are_others_each_time():
    assert access_for("10.0.0.1").tokens != access_for("10.0.0.1").tokens


def test_nobody_commands_a_read_only_window():
    assert access_for(None, is_read_only=True).rights(HERE, "/") == ("watch",)
    shown = access_for("10.0.0.1", is_read_only=True)
    assert list(shown.addresses("10.0.0.1", 7680)) == ["watch"]
    (target,) = shown.addresses("10.0.0.1", 7680).values()
    assert shown.rights("10.0.0.1:7680", target.partition("7680")[2]) == ("watch",)


def test_a_server_at_all_addresses_answers_to_numbers_and_its_own_names():
    access = access_for("0.0.0.0", ["Lab-7"])  # noqa: S104 - the rules for it
    for host in ("192.168.1.20:7680", "10.1.2.3", "lab-7:7680", "[fe80::1]:7680", "localhost"):
        access.check_host(host)
    with pytest.raises(Refused):
        access.check_host("evil.example:7680")


def test_every_answer_lets_the_page_load_nothing_from_elsewhere():
    policy = dict(part.split(" ", 1) for part in HEADERS["Content-Security-Policy"].split("; "))
    assert policy["default-src"] == "'none'"
    assert policy["frame-ancestors"] == "'none'"
    assert {policy[name] for name in ("script-src", "style-src", "connect-src")} == {"'self'"}
    assert "unsafe" not in HEADERS["Content-Security-Policy"]
    assert HEADERS["X-Content-Type-Options"] == "nosniff"
