"""The comments of types' files."""

import pytest

from lcmtools.packages.placed_type import Comment, comments
from lcmtools.packages.type_files import LcmFile

LCM = """\
package a;

// A pose,
// in two parts.
struct Pose
{
    // number of points
    int32_t n;

    // of nothing: a blank line follows

    // [m/s, rad/s] how fast
    geometry_msgs.Twist speed;
    double points[n][3];

    // a level
    const int8_t DEBUG = 1;
    // [1] share
    float share; // behind it
}
"""
MSG = """\
# A pose
float64 x  # [m] forward
geometry_msgs/Point[] points
int32 LEVEL=3 # a constant
"""


def test_comments_above_are_of_what_follows():
    assert comments(LcmFile("x.lcm", LCM.encode()), "a/Pose") == {
        "": Comment("A pose, in two parts."),
        "n": Comment("number of points"),
        "speed": Comment("how fast", "m/s, rad/s"),
        "points": Comment(),
        "share": Comment("behind it"),
    }


def test_comments_behind_are_of_their_line_in_files_of_ros():
    found = comments(LcmFile("Pose.msg", MSG.encode(), "a"), "a/Pose")
    assert found["x"] == Comment("forward", "m")
    assert found["points"] == Comment()


@pytest.mark.parametrize(
    ("text", "about", "x"),
    [
        ("/* A pose,\n * in two\n * parts. */\nstruct P { float x; }", "A pose, in two parts.", ()),
        ("struct P { // A pose\n float a, /* [m] this */ x;\n}", "A pose", ("this", "m")),
        ("// A pose\nstruct P\n{\n // [m] both\n float a, x; }", "A pose", ("both", "m")),
        ("struct Q { // of Q\n float x; // of Q.x\n}\n// P's\nstruct P { float x; }", "P's", ()),
        ("struct P {\n // [m] see http://a.b/c/\n float x; }", "", ("see http://a.b/c/", "m")),
    ],
)
def test_comments_may_be_anywhere(text, about, x):
    found = comments(LcmFile("p.lcm", text.encode()), "P")
    assert found[""].text == about
    assert found.get("x", Comment()) == Comment(*x)


def test_the_parts_of_a_service_have_comments_of_their_own():
    file = LcmFile("S.srv", b"int8 a # one\n---\nint8 a # two\n", "p")
    found = [comments(file, f"p/S_{part}")["a"].text for part in ("Request", "Response")]
    assert found == ["one", "two"]


def test_a_file_that_cannot_be_read_has_no_comments():
    assert comments(LcmFile("p.lcm", b"// A pose\nstruct P { float x }"), "P") == {}
