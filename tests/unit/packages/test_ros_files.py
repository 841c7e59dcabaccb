"""ROS's .msg and .srv files become the types that lcm-gen makes of the equivalent .lcm files."""

from pathlib import Path

import pytest
from fixtures.limits import small_files
from fixtures.says import assert_says, raises_saying
from hypothesis import given
from hypothesis import strategies as st

from lcmtools.errors import InvalidFile, LcmtoolsError
from lcmtools.messages.definition import definition
from lcmtools.messages.registry import Registry, fingerprint
from lcmtools.messages.type_source import TypeSource
from lcmtools.packages.finding import find_node
from lcmtools.packages.lcm_gen import generate_code
from lcmtools.packages.ros_files import to_lcm
from lcmtools.packages.runnable_nodes import Runnable
from lcmtools.packages.user_types import UserTypes
from lcmtools.packages.workspace import Workspace, workspace
from lcmtools.types.fingerprints import FINGERPRINTS

EVERYTHING = """\
# a comment
Header header             # as of std_msgs

bool flag
byte b
char c
int8 i8
uint8 u8
int16 i16
uint16 u16
int32 i32
uint32 u32
int64 i64
uint64 u64
float32 f32
float64 f64
string<=10 text
time start
duration length
float64[36] covariance
float64[]   ranges
string[<=3] names
uint8[] data
geometry_msgs/Twist twist
std_msgs/msg/Header[2] more
Part[] parts
"""
AS_LCM = """package b;
struct Everything {
  int32_t ranges_length; int32_t names_length; int32_t data_length; int32_t parts_length;
  std_msgs.Header header; boolean flag; int8_t b; byte c; int8_t i8; byte u8;
  int16_t i16; int16_t u16; int32_t i32; int32_t u32; int64_t i64; int64_t u64;
  float f32; double f64; string text; std_msgs.Time start; std_msgs.Duration length;
  double covariance[36]; double ranges[ranges_length]; string names[names_length];
  byte data[data_length]; geometry_msgs.Twist twist; std_msgs.Header more[2];
  Part parts[parts_length];
}
"""
PART = "package b; struct Part { int16_t x; }"


def registry(types):
    return Registry([TypeSource("lcmtools.types", FINGERPRINTS)], lambda: types)


def problems(types):
    found = types.workspace()
    return [str(problem.error()) for problem in found.problems] if found else []


def test_a_msg_file_has_the_fingerprint_of_the_equivalent_lcm_file(write, types_of):
    folder = write(
        {
            "a/msg/Everything.msg": EVERYTHING,
            "a/msg/Part.msg": "int16 x\n",
            "b/Everything.lcm": AS_LCM,
            "b/Part.lcm": PART,
        }
    )
    known = registry(types_of(folder))
    assert known.problems() == []
    ours, theirs = known.message_class("a/Everything"), known.message_class("b/Everything")
    assert fingerprint(ours) == fingerprint(theirs)
    assert known.files()["a/Everything"] == str(folder / "a/msg/Everything.msg")


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("geometry_msgs/Pose", "Point position\nQuaternion orientation"),
        ("geometry_msgs/TwistStamped", "Header header\nTwist twist\n"),
        ("nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"),
        ("std_msgs/UInt64", "uint64 data"),
        ("std_msgs/Char", "char data"),
        ("std_msgs/Empty", "# nothing\n"),
        (
            "sensor_msgs/LaserScan",
            (
                "Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
                "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\n"
                "float32[] ranges\nfloat32[] intensities\n"
            ),
        ),
        (
            "sensor_msgs/JointState",
            (
                "Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
                "float64[] effort\n"
            ),
        ),
        ("air_lab0/ControllerEvaluationStat", "uint32 samples\nfloat64 last\nfloat64 average\n"),
    ],
)
def test_ros_definitions_have_the_shipped_types_fingerprints(write, types_of, name, text):
    package, _, short = name.partition("/")
    types = types_of(write({f"{package}/msg/{short}.msg": text}))
    source = types.workspace()
    assert source is not None
    if package == "air_lab0":  # fields' names are part of the fingerprint
        text = text.replace("last", "last_error").replace("average", "average_error")
        assert source.fingerprints[name] != FINGERPRINTS[name]
        types = types_of(write({f"{package}/msg/{short}.msg": text}))
        source = types.workspace()
        assert source is not None
    assert (source.fingerprints[name], problems(types)) == (FINGERPRINTS[name], [])


def test_constants_have_their_values_and_text_too(write, types_of):
    text = (
        "uint8 OK=0\nuint8 BAD = 200 # bad\nint64 BIG=-5000000000\nint32 HEX=0x1F\nbool YES=True\n"
        "float32 HALF=0.5\nfloat64 TINY=1e-30\nstring NAME=  a 'b' # no comment\n"
        'string QUOTED = "left"\nchar A=65\nuint8 state\n'
    )
    known = registry(types_of(write({"p/msg/C.msg": text})))
    cls = known.message_class("p/C")
    names = ("OK", "BAD", "BIG", "HEX", "YES", "HALF", "TINY", "NAME", "QUOTED", "A")
    found = [getattr(cls, name) for name in names]
    assert found == [0, 200, -5_000_000_000, 31, 1, 0.5, 1e-30, "a 'b' # no comment", "left", 65]
    assert "string NAME=a 'b' # no comment" in definition(cls).splitlines()
    assert problems(types_of(write({}))) == []


def test_a_service_is_a_pair_of_types(write, types_of):
    text = "# to where\nfloat64[] goal\n---\nbool success\nstring message\n"
    known = registry(types_of(write({"p/srv/Drive.srv": text, "p/srv/Stop.srv": "---\n"})))
    assert known.service_names() == ["p/Drive", "p/Stop"]
    pair = known.service_class("p/Drive")
    assert definition(pair.Request) == "float64[] goal"
    assert definition(pair.Response) == "bool success\nstring message"
    assert definition(known.service_class("p/Stop").Response) == ""


def test_an_action_is_three_types(write, types_of):
    folder = write({"p/action/Dock.action": "uint8 FAST=1\nint32 dock\n---\n---\nfloat32 left\n"})
    types = types_of(folder)
    known, source = registry(types), types.workspace()
    assert source is not None
    assert list(source.fingerprints) == ["p/Dock_Feedback", "p/Dock_Goal", "p/Dock_Result"]
    assert source.problems == []
    texts = [definition(known.message_class(f"p/Dock_{part}")) for part in ("Goal", "Feedback")]
    assert texts == ["uint8 FAST=1\nint32 dock", "float32 left"]


def test_types_of_a_ros_package_in_the_workspace_are_found(write):
    root = write(
        {
            "src/survey_msgs/package.xml": "<package><name>survey_msgs</name></package>",
            "src/survey_msgs/msg/Progress.msg": "int32 x",
            "src/survey_msgs/scripts/talker.py": "def main(): ...",
            "src/driver/package.xml": "<package><name>driver</name></package>",
            "src/notes/msg/A.msg": "int32 x",
        }
    )
    environment = {"XDG_CACHE_HOME": str(root / "cache")}
    for start in (root, root / "src/survey_msgs/scripts"):
        found = UserTypes(environment, [start], FINGERPRINTS).workspace()
        assert found is not None
        assert (list(found.fingerprints), found.problems) == (["survey_msgs/Progress"], [])
    assert workspace(root) == Workspace([], [])  # no package of lcmtools, with nodes to run
    talker = Runnable("lcmtools", "talker", "")
    assert find_node(["talker"], [talker], root) == (talker, [])


@pytest.mark.parametrize(
    ("files", "name"),
    [
        ({"p/msg/A.msg": "int8 x"}, "p/A"),
        ({"p/A.msg": "int8 x"}, "p/A"),
        ({"src/p-1/msg/A.msg": "int8 x", "src/p-1/package.xml": "<name>real</name>"}, "real/A"),
        (
            {
                "q/msg/A.msg": "int8 x",
                "q/pyproject.toml": '[project]\nname = "my-lab"\n[tool.lcmtools]\n',
            },
            "my_lab/A",
        ),
    ],
)
def test_the_package_is_the_folder_s_or_what_its_project_says(write, types_of, files, name):
    found = types_of(write(files)).workspace()
    assert found is not None
    assert (list(found.fingerprints), found.problems) == ([name], [])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("double x", "M.msg:1: unknown type 'double'; did you mean float64?"),
        ("\nint x", "M.msg:2: unknown type 'int'; did you mean int32 or int64?"),
        ("doubel x", "M.msg:1: unknown type 'doubel'; did you mean float64?"),
        ("boolena x", "M.msg:1: unknown type 'boolena'; did you mean bool?"),
        ("flaot64 x", "M.msg:1: unknown type 'flaot64'; did you mean float64?"),
        ("int8 ok\nfloat64", "M.msg:2: cannot read 'float64'; {example}"),
        ("float64 x;", "M.msg:1: 'float64 x;' ends in ';'; lines of ROS have none"),
        (
            "int32 speed 5",
            "M.msg:1: speed has a default value, which LCM does not support; {zeros}",
        ),
        ("float64 2nd", "M.msg:1: cannot read 'float64 2nd'; {example}"),
        ("float64[2][2] m", "M.msg:1: cannot read 'float64[2][2] m'; {example}"),
        ("uint8 X=300", "M.msg:1: 300 does not fit uint8 (0..255)"),
        ("int32 X=a", "M.msg:1: 'a' is not a value of int32, the type of X"),
        ("float64 X=nan", "M.msg:1: 'nan' is not a value of float64, the type of X"),
        ("uint64 X=0xFFFFFFFFFFFFFFFF", "M.msg:1: X is {most}"),
        ("geometry_msgs/Twist X=1", "M.msg:1: a constant cannot be of the type {twist}"),
        (
            "geometry_msgs/Twst t",
            "M.msg:1: p/M: unknown type 'geometry_msgs/Twst'; did you mean geometry_msgs/Twist?",
        ),
        ("# x\nTwist t", "M.msg:2: p/M: unknown type 'Twist'; did you mean geometry_msgs/Twist?"),
        ("int8 x\nint8 x", "M.msg:2: Duplicate member name 'x'"),
    ],
)
def test_a_mistake_is_named_with_its_line(write, types_of, text, said):
    words = {
        "example": "write  float64[] values  or  int32 LIMIT=5",
        "zeros": "leave it out: a new message has zeros",
        "most": "larger than LCM's largest number, 2^63 - 1",
        "twist": "geometry_msgs/Twist",
    }
    folder = write({"p/msg/M.msg": text})
    assert problems(types_of(folder)) == [f"{folder}/p/msg/{said.format_map(words)}"]


def test_files_that_cannot_be_types_are_named(write, types_of):
    folder = write({"p/msg/my-type.msg": "int8 x", "p/srv/Go.srv": "int8 x\n"})
    (folder / "p/msg/Mail.msg").write_bytes(b"\xd0\xcf\x11\xe0")
    mail, name, service = problems(types_of(folder))
    assert_says(mail, f"{folder}/p/msg/Mail.msg:1: ", "UTF-8")
    assert_says(name, f"{folder}/p/msg/my-type.msg: ", "'my-type'", "name", "; letters, digits")
    assert_says(service, f"{folder}/p/srv/Go.srv:1: ", "---", "Go_Response", "missing")
    with pytest.raises(InvalidFile, match=r"Go\.srv:1: a line of ---"):
        registry(types_of(folder)).service_class("p/Go")


def test_a_changed_file_is_read_again(write, types_of):
    folder = write({"p/msg/A.msg": "string NAME=a\nint8 x"})
    assert registry(types_of(folder)).message_class("p/A").NAME == "a"
    write({"p/msg/A.msg": "string NAME=b\nint8 x"})
    assert registry(types_of(folder)).message_class("p/A").NAME == "b"


def test_code_for_other_languages_is_generated(write, tmp_path):
    folder = write({"p/msg/A.msg": "float64[] values\n", "p/srv/Go.srv": "int8 x\n---\n"})
    files = [folder / "p/msg/A.msg", folder / "p/srv/Go.srv"]
    made = generate_code(files, "cpp", tmp_path / "generated")
    names = [path.relative_to(tmp_path / "generated").as_posix() for path in made]
    assert names == ["p/A.hpp", "p/Go_Request.hpp", "p/Go_Response.hpp"]
    assert "std::vector< double > values;" in made[0].read_text()
    before = made[0].stat().st_mtime_ns, made[1].stat().st_mtime_ns
    made[1].write_text("changed")
    generate_code(files, "cpp", tmp_path / "generated")
    assert made[0].stat().st_mtime_ns == before[0]  # make compiles nothing that includes it
    assert "changed" not in made[1].read_text()


def test_enums_get_code_in_cpp_as_lcm_gen_writes_none(write, types_of, tmp_path):
    text = "package a.b; enum Gear { LOW = 0, BACK = -1 } struct Shift { Gear gear; }"
    folder = write({"e.lcm": text, "f.lcm": "enum Bare { ONE = 1 }"})
    made = generate_code([folder / "e.lcm", folder / "f.lcm"], "cpp", tmp_path / "generated")
    names = [path.relative_to(tmp_path / "generated").as_posix() for path in made]
    assert names == ["Bare.hpp", "a/b/Gear.hpp", "a/b/Shift.hpp"]
    header = made[1].read_text()
    assert_says(
        header, "namespace a {\nnamespace b {", "enum Value : int32_t { LOW = 0, BACK = -1 }"
    )
    number = registry(types_of(folder)).enum_class("a.b/Gear").__hash_number__
    assert f"return {number:#x};" in header


_KEYWORDS = {
    "p/msg/A.msg": "# class\nstring A=class\nint8 from\nstring class\n",
    "b.lcm": "package p; // class\nstruct B {\n  /* new */ int32_t x;\n  int32_t new;\n}\n",
    "c.lcm": "package p;\nstruct C {\n  const int32_t register = 3;\n}\n",
    "d.lcm": "package p.in;\nstruct D { int8_t final; }\n",
    "e.lcm": "package p;\nstruct E {\n  double classes;\n  boolean is_new;\n  int8_t xor_;\n}\n",
}


@pytest.mark.parametrize(
    ("file", "language", "error"),
    [
        ("p/msg/A.msg", "cpp", "A.msg:4: 'class' is a keyword of C++; use another name"),
        ("p/msg/A.msg", "python", "A.msg:3: 'from' is a keyword of Python; use another name"),
        ("p/msg/A.msg", "java", "A.msg:4: 'class' is a keyword of Java; use another name"),
        ("p/msg/A.msg", "c", ""),
        ("b.lcm", "cpp", "b.lcm:4: 'new' is a keyword of C++; use another name"),
        ("c.lcm", "c", "c.lcm:3: 'register' is a keyword of C; use another name"),
        ("c.lcm", "cpp", "c.lcm:3: 'register' is a keyword of C++; use another name"),
        ("d.lcm", "python", "d.lcm:1: 'in' is a keyword of Python; use another name"),
        ("d.lcm", "java", "d.lcm:2: 'final' is a keyword of Java; use another name"),
        ("d.lcm", "cpp", ""),
        *[("e.lcm", language, "") for language in ("c", "cpp", "java", "python")],
    ],
)
def test_a_name_that_is_a_keyword_of_the_language_is_an_error_with_its_line(
    file, language, error, write, tmp_path
):
    source, target = write(_KEYWORDS) / file, tmp_path / "generated"
    if not error:
        assert generate_code([source], language, target)
        return
    with raises_saying(InvalidFile, error):
        generate_code([source], language, target)
    assert not target.exists()


def test_a_full_disk_of_which_lcm_gen_says_nothing_leaves_no_code(write, tmp_path):
    folder = write({"p/msg/A.msg": "float64[] values\n"})
    with small_files(), raises_saying(LcmtoolsError, "cannot write", ": File too large"):
        generate_code([folder / "p/msg/A.msg"], "cpp", tmp_path / "generated")
    assert not (tmp_path / "generated").exists()


@given(st.text(max_size=200), st.sampled_from([".msg", ".srv", ".action"]))
def test_any_text_is_survived_with_its_lines(text, suffix):
    source = to_lcm(Path(f"/p/Name{suffix}"), text.encode("utf-8", "replace"), "p")
    if not source.problems:
        assert len(source.text.splitlines()) <= len(text.splitlines()) + 1
