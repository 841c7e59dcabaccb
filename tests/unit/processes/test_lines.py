"""Bytes of a process, as lines."""

from lcmtools.processes.child import LONGEST, Lines


def test_lines_come_when_they_are_whole_and_the_rest_at_the_end():
    lines = Lines()
    assert lines.feed(b"a\nb") == ["a"]
    assert lines.feed(b"c\r\n\nd") == ["bc", ""]
    assert lines.end() == ["d"]
    assert lines.end() == []


def test_line_without_end_comes_in_pieces():
    lines = Lines()
    assert [len(line) for line in lines.feed(b"x" * (LONGEST + 1))] == [LONGEST + 1]
    assert lines.end() == []


def test_bytes_that_are_no_text_are_shown():
    assert Lines().feed(b"\xe9t\xe9\n") == ["\\xe9t\\xe9"]
