"""docs/wtf.md has the rules of wtf as they are."""

import pytest
from wtf_page import PAGE, page, shown


def test_committed_page_is_fresh():
    assert PAGE.read_text(encoding="utf-8") == page(), "run: make docs"


@pytest.mark.parametrize(
    ("sentence", "text"),
    [
        ("{interface} is down", "eth0 is down"),
        ("wake it (`kill -CONT {pid}`)", "wake it (kill -CONT 4711)"),
        ("{process} (pid {process.pid})", "python my_driver.py (pid 4711)"),
        ("{seconds:time} ahead, {rate:.3g} Hz", "2.5 s ahead, 12 Hz"),
        ("{seconds:.0f} s ago", "2.5 s ago"),
        ("{count} more{messages:count}", "3 more"),
        ("{hint:advice}`{hint:command}`", "sudo ip link set lo multicast on"),
        ("[[0]] of {{x}}", "[[0]] of {x}"),
    ],
)
def test_sentences_have_examples_of_their_parts(sentence, text):
    assert shown(sentence) == text
