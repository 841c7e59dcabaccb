"""The .lcm files: laid out alike and documented field by field."""

import re
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[3] / "lcm_types"
FILES = {
    path.relative_to(SOURCES).as_posix(): path.read_text().splitlines()
    for path in sorted(SOURCES.glob("*/*.lcm"))
}
MEMBER = re.compile(r" {4}(const )?(\w[\w.]*) (\w+)(?: = \S+|((?:\[\w+\])*));")

# Their numbers have the unit that the topic, or the message around them, says.
WITHOUT_UNIT = ("std_msgs/", "geometry_msgs/Vector3.lcm", "sensor_msgs/ChannelFloat32.lcm")


def members(lines: list[str]) -> list[tuple[int, re.Match[str]]]:
    """Return the members of a struct with the numbers of their lines."""
    matches = ((number, MEMBER.fullmatch(line)) for number, line in enumerate(lines))
    return [(number, match) for number, match in matches if match]


def comment_above(lines: list[str], number: int) -> str:
    """Return the comment that stands right above a line, "" for none."""
    first = number
    while lines[first - 1].lstrip().startswith("//"):
        first -= 1
    return " ".join(line.strip().removeprefix("//").strip() for line in lines[first:number])


@pytest.mark.parametrize("name", FILES)
def test_file_holds_the_struct_that_it_is_named_for(name: str) -> None:
    package, struct = name.removesuffix(".lcm").split("/")
    assert FILES[name][0] == f"package {package};"
    assert [line for line in FILES[name] if "struct" in line.split()] == [f"struct {struct}"]


@pytest.mark.parametrize("name", FILES)
def test_struct_says_what_it_is(name: str) -> None:
    struct = next(i for i, line in enumerate(FILES[name]) if line.startswith("struct "))
    assert comment_above(FILES[name], struct).endswith(".")


@pytest.mark.parametrize("name", FILES)
def test_every_member_has_a_comment_above_it(name: str) -> None:
    lines = FILES[name]
    bare = [lines[number] for number, _ in members(lines) if not comment_above(lines, number)]
    assert bare == []


@pytest.mark.parametrize("name", FILES)
def test_every_line_is_a_member_or_a_comment_of_its_own(name: str) -> None:
    # lcm-gen would give a comment behind a member to the next one.
    lines = FILES[name]
    body = lines[lines.index("{") + 1 : lines.index("}")]
    others = [line for line in body if line and not line.startswith("    // ")]
    assert [line for line in others if not MEMBER.fullmatch(line)] == []


@pytest.mark.parametrize("name", [name for name in FILES if not name.startswith(WITHOUT_UNIT)])
def test_numbers_of_a_quantity_have_their_unit(name: str) -> None:
    lines = FILES[name]
    comments = {
        match[3]: comment_above(lines, number)
        for number, match in members(lines)
        if match[2] in {"double", "float"} and not match[1]
    }
    assert [field for field, text in comments.items() if not text.startswith("[")] == []


@pytest.mark.parametrize("name", FILES)
def test_lengths_come_first_and_are_named_for_their_arrays(name: str) -> None:
    fields = [match for _, match in members(FILES[name]) if not match[1]]
    arrays = [match[3] for match in fields if match[4] and not match[4][1:-1].isdigit()]
    lengths = [(match[2], match[3]) for match in fields[: len(arrays)]]
    assert lengths == [("int32_t", f"{array}_length") for array in arrays]
    assert all(match[4] == f"[{match[3]}_length]" for match in fields if match[3] in arrays)
