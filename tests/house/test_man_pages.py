"""There is a man page for every command, and man shows each without a warning."""

from man_pages import commands, page

PAGES = [*commands()]
KNOWN = {".TH", ".SH", ".B", ".BR", ".I", ".PP", ".TP", ".nf", ".fi"}


def test_pages_have_what_a_page_has_and_no_line_that_roff_misreads():
    for words in PAGES:
        rows = page(words).splitlines()
        assert [row for row in rows if row.startswith(".SH")][:4] == [
            ".SH NAME",
            ".SH SYNOPSIS",
            ".SH DESCRIPTION",
            ".SH EXAMPLES",
        ], words
        assert {row.split()[0] for row in rows if row.startswith((".", "'"))} <= KNOWN, words
        assert "" not in rows, words


def test_page_of_echo_says_what_its_help_says():
    rows = page(("lcmtools", "echo")).splitlines()
    assert "lcmtools\\-echo \\- print the messages of a topic" in rows
    assert "[OPTIONS] TOPIC... [TYPE]" in rows
    assert "[OPTIONS] [TYPE]" in page(("lcmtools", "msg", "show")).splitlines()
    assert "[OPTIONS] [FILE] [NODE]" in page(("lcmtools", "param", "dump")).splitlines()
    assert ".B \\-1, \\-\\-once" in rows
    assert rows[rows.index(".SH EXAMPLES") + 1] == ".nf"
    assert ".B LCM_DEFAULT_URL" in rows
