"""LCM_SELF_TEST, which liblcm sends: no type, and nowhere an unknown one."""

import json

import pytest


@pytest.fixture
def log(log_of):
    return log_of("LCM_SELF_TEST", b"lcm self test")


@pytest.mark.parametrize(
    "words",
    [
        ("list", "-b", "{}", "--all", "-t"),
        ("list", "-b", "{}", "--all", "-v"),
        ("info", "-b", "{}", "LCM_SELF_TEST"),
        ("type", "-b", "{}", "LCM_SELF_TEST"),
        ("bag", "info", "{}"),
        ("spy", "-b", "{}", "--all", "--once"),
        ("echo", "-b", "{}", "LCM_SELF_TEST"),
        ("wtf", "--bag", "{}"),
    ],
)
def test_its_type_is_not_unknown(cli, log, words):
    told = cli(*(word.format(log) for word in words))
    assert told.code == 0, told
    assert "unknown type" not in told.out + told.err
    assert " ? " not in told.out


def test_json_has_null_for_its_type_and_for_a_sender_that_is_not_known(cli, log):
    (row,) = json.loads(cli("list", "-b", log, "--all", "--json").ok())
    assert (row["type"], row["types"], row["other_senders"]) == (None, [], [None])
    (record,) = json.loads(cli("info", "-b", log, "LCM_SELF_TEST", "--json").ok())
    assert (record["type"], record["other_publishers"][0]["sender"]) == (None, None)
    record = json.loads(cli("type", "-b", log, "LCM_SELF_TEST", "--json").ok())
    assert (record["type"], record["types"]) == (None, [])
