"""The .lcm files: laid out alike and documented field by field."""

import re
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[3] / "lcm_types"
FILES = {
    path.relative_to(SOURCES).as_posix(): path.read_text().splitlines()
    for path in sorted(SOURCES.glob("*/*.lcm"))
}
MEMBER = re.compile(r" {4}(const )?(\w[\w.]*) (\w+)(?: = \S+|((?:\[\w+\])*));")

# Their numbers have the unit that the topic, or the message around them, says.
WITHOUT_UNIT = ("std_msgs/", "geometry_msgs/Vector3.lcm", "sensor_msgs/ChannelFloat32.lcm")


def members(lines):
    """Return the members of a struct with the numbers of their lines."""
    matches = ((number, MEMBER.fullmatch(line)) for number, line in enumerate(lines))
    return [(number, match) for number, match in matches if match]


def comment_above(lines, number):
    """Return the comment that stands right above a line, "" for none."""
    first = number
    while lines[first - 1].lstrip().startswith("//"):
        first -= 1
    return " ".join(line.strip().removeprefix("//").strip() for line in lines[first:number])


def test_file_holds_the_struct_that_it_is_named_for():
    for name, lines in FILES.items():
        package, struct = name.removesuffix(".lcm").split("/")
        assert lines[0] == f"package {package};"
        assert [line for line in lines if line.split()[:1] == ["struct"]] == [f"struct {struct}"]


def test_struct_says_what_it_is():
    for name, lines in FILES.items():
        struct = next(i for i, line in enumerate(lines) if line.startswith("struct "))
        assert comment_above(lines, struct).endswith("."), name


def test_every_member_has_a_comment_above_it():
    for name, lines in FILES.items():
        bare = [lines[number] for number, _ in members(lines) if not comment_above(lines, number)]
        assert bare == [], name


def test_every_line_is_a_member_or_a_comment_of_its_own():
    # lcm-gen would give a comment behind a member to the next one.
    for name, lines in FILES.items():
        body = lines[lines.index("{") + 1 : lines.index("}")]
        others = [line for line in body if line and not line.startswith("    // ")]
        assert [line for line in others if not MEMBER.fullmatch(line)] == [], name


def test_numbers_of_a_quantity_have_their_unit():
    for name, lines in FILES.items():
        comments = {
            match[3]: comment_above(lines, number)
            for number, match in members(lines)
            if match[2] in {"double", "float"} and not match[1]
        }
        if not name.startswith(WITHOUT_UNIT):
            without = [field for field, text in comments.items() if not text.startswith("[")]
            assert without == [], name


def test_lengths_come_first_and_are_named_for_their_arrays():
    for name, lines in FILES.items():
        fields = [match for _, match in members(lines) if not match[1]]
        arrays = [match[3] for match in fields if match[4] and not match[4][1:-1].isdigit()]
        lengths = [(match[2], match[3]) for match in fields[: len(arrays)]]
        assert lengths == [("int32_t", f"{array}_length") for array in arrays], name
        assert all(match[4] == f"[{match[3]}_length]" for match in fields if match[3] in arrays)
