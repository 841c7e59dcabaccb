"""The table of rostopic hz."""

from lcmtools.observe.measuring.rate_report import table


def test_a_table_has_a_centred_header_a_rule_and_columns_as_wide_as_they_need() -> None:
    header = ("topic", "rate", "min_delta", "max_delta", "std_dev", "window")
    cells = ("/chatter", "10.0", "0.09982", "0.1002", "0.0001011", "10")
    assert table(header, [cells]) == [
        " topic     rate   min_delta   max_delta    std_dev    window",
        "=" * 60,
        "/chatter   10.0   0.09982     0.1002      0.0001011   10",
        "",
    ]


def test_a_table_keeps_the_cells_of_each_row() -> None:
    rows = [("/a", "10"), ("/longer", "2")]
    assert table(("topic", "window"), rows)[2:4] == ["/a        10", "/longer   2"]
