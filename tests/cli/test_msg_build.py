"""msg build says what it has done, also where there was nothing to do."""

import pytest


@pytest.mark.parametrize(
    ("structs", "said"),
    [
        ("", "no .lcm, .msg, .srv or .action files that define types in "),
        ("struct a_t { int32_t x; }", "1 type compiled in "),
        ("struct a_t { int32_t x; }\nstruct b_t { a_t a; }", "2 types compiled in "),
    ],
)
def test_msg_build_says_what_was_done(structs, said, tmp_path, cli):
    (tmp_path / "own.lcm").write_text(f"package own;\n{structs}")
    done = cli("msg", "build", str(tmp_path))
    assert done.code == 0
    assert done.err.startswith(said)
    assert done.out.count("\n") == structs.count("struct")
