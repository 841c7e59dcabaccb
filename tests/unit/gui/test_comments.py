"""The comments of types' files."""

from lcmtools.packages.comments import Comment, comments

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
    assert comments(LCM) == {
        "": Comment("A pose, in two parts."),
        "n": Comment("number of points"),
        "speed": Comment("how fast", "m/s, rad/s"),
        "points": Comment(),
        "share": Comment("behind it"),
    }


def test_comments_behind_are_of_their_line_in_files_of_ros():
    found = comments(MSG)
    assert found["x"] == Comment("forward", "m")
    assert found["points"] == Comment()
