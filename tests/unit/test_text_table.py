"""Tables of text: plain ones, and with the heading of rostopic hz."""

from lcmtools.text_table import plural, text_table


def test_columns_are_as_wide_as_they_need_and_no_line_ends_with_blanks():
    assert text_table([("a", "bc", ""), ("def", "g", "h")]) == ["a    bc", "def  g   h"]
    assert text_table([]) == []


def test_a_heading_is_centred_above_a_rule():
    heading = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")
    cells = ("/chatter", "10.0", "0.09982", "0.1002", "0.0001011", "10")
    assert text_table([cells], heading) == [
        " topic     rate   min_delta   max_delta    std_dev    window",
        "=" * 60,
        "/chatter   10.0   0.09982     0.1002      0.0001011   10",
    ]


def test_rows_below_a_heading_keep_their_cells():
    rows = [("/a", "10"), ("/longer", "2")]
    assert text_table(rows, ("topic", "window"))[2:] == ["/a        10", "/longer   2"]


def test_one_thing_has_no_plural():
    assert [plural(n, "line") for n in (0, 1, 2)] == ["0 lines", "1 line", "2 lines"]
