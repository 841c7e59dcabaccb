"""docs/wtf.md has the rules of wtf as they are."""

import pytest
from wtf_page import PAGE, page, shown


def test_committed_page_is_fresh() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: make docs"


@pytest.mark.parametrize(
    ("sentence", "text"),
    [
        ("{bus} is down", "BUS is down"),
        ("wake it (`kill -CONT {pid}`)", "wake it (kill -CONT PID)"),
        ("{process} (pid {process.pid})", "PROCESS (pid PID)"),
        ("{seconds:time} ahead, {rate:.3g} Hz", "TIME ahead, RATE Hz"),
        ("{text}{messages:count}", "TEXT"),
        ("{hint:advice}`{hint:command}`", "COMMAND"),
        ("[[0]] of {{x}}", "[[0]] of {x}"),
    ],
)
def test_sentences_have_their_parts_in_capitals(sentence: str, text: str) -> None:
    assert shown(sentence) == text
