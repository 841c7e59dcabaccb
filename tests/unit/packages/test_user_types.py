"""From .lcm files to types that can be used: what is made, what is refused, and what is kept."""

import marshal
import threading

import pytest
from fixtures.says import assert_says

from lcmtools.errors import UnknownType
from lcmtools.messages.codec import decode, encode
from lcmtools.messages.registry import Registry, fingerprint, message_class, type_name
from lcmtools.messages.supply import set_supply
from lcmtools.messages.type_source import TypeSource
from lcmtools.packages import cache, provide_user_types
from lcmtools.packages.placed_type import parse_file
from lcmtools.packages.user_types import UserTypes
from lcmtools.types.fingerprints import FINGERPRINTS
from lcmtools.types.geometry_msgs import Twist

STAT = "package lab;\nstruct Stat\n{\n  int32_t samples;\n  geometry_msgs.Twist twist;\n}\n"


def registry(types):
    return Registry([TypeSource("lcmtools.types", FINGERPRINTS)], lambda: types)


def near(types):
    found = types.workspace()
    assert found is not None
    return found


def test_types_are_made_of_shipped_types_and_of_each_other_across_packages(write, types_of):
    folder = write(
        {
            "lab/Stat.lcm": STAT,
            "b/More.lcm": "package other.deep;\nstruct More { lab.Stat first; Last last; }\n",
            "b/Last.lcm": "package other.deep;\nstruct Last { int32_t n; double values[n]; }\n",
            "plain.lcm": "struct plain_t { other.deep.More more; }\n",
        }
    )
    known = registry(types_of(folder))
    more = known.message_class("other.deep.More")()
    assert type(more.first.twist) is Twist
    more.first.twist.linear.x, more.last.values = 0.5, [1.0, 2.0]
    back = decode(type(more), encode(more))
    assert (back.first.twist.linear.x, back.last.values) == (0.5, (1.0, 2.0))
    assert type_name(type(more)) == "other.deep/More"
    plain = known.message_class("plain_t")()
    assert type_name(type(plain)) == "plain_t"
    assert type(plain.more) is type(more)
    assert type_name(Twist) == "geometry_msgs/Twist"
    assert {"lab/Stat", "other.deep/More", "plain_t"} <= set(known.type_names())


def test_a_file_without_a_package_does_not_take_the_one_of_the_file_before(write, types_of):
    folder = write({"a.lcm": "package p;\nstruct A { byte x; }\n", "b.lcm": "struct B { A a; }\n"})
    source = near(types_of(folder))
    assert set(source.fingerprints) == {"p/A"}
    assert source.problems[0].what == "B: unknown type 'A'"
    assert source.problems[0].hint == "did you mean p.A?"


def test_fingerprint_leads_to_the_type(write, types_of):
    known = registry(types_of(write({"Stat.lcm": STAT})))
    cls = known.message_class("lab/Stat")
    assert known.candidates(fingerprint(cls)) == ["lab/Stat"]


def test_own_type_counts_and_the_shipped_one_is_found_by_its_fingerprint(write, types_of):
    said = []
    types = types_of(write({"s.lcm": "package std_msgs;\nstruct String { string text; }\n"}))
    known = Registry([TypeSource("lcmtools.types", FINGERPRINTS)], lambda: types, said.append)
    own = known.message_class("std_msgs/String")
    assert own.__slots__ == ["text"]
    number = FINGERPRINTS["std_msgs/String"]
    assert known.candidates(number) == ["std_msgs/String"]
    assert known.message_class("std_msgs/String", number).__slots__ == ["data"]
    assert len(said) == 1
    assert_says(said[0], "lcmtools: std_msgs/String", "differs", "; ")


def test_of_two_folders_with_the_same_type_the_first_counts_and_that_is_said(tmp_path, types_of):
    for name, field in (("a", "double x"), ("b", "double y"), ("c", "double x")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "T.lcm").write_text(f"package p;\nstruct T {{ {field}; }}\n")
    a, b, c = (tmp_path / name for name in "abc")
    assert near(types_of(a, c)).notes == {}, "the same twice is no fault"
    source = near(types_of(b, a))
    assert source.files["p/T"] == str(b / "T.lcm")
    ((kind, note),) = source.notes.items()
    assert kind == "p/T"
    assert_says(note, "p/T", "differently", str(b / "T.lcm"), str(a / "T.lcm"))


@pytest.mark.parametrize(
    ("text", "line", "what", "hint"),
    [
        ("package p;\nstruct T {\n  double x\n}\n", 4, "expected token ;", "a ';' is missing"),
        ("package p;\nstruct T{\n double x;\n}\n", 3, "expected token {", "lcm-gen wants a space"),
        ("double x;\n", 1, "Missing struct token", "a file is  package name;"),
        (
            "struct T { double x[]; }",
            1,
            "Array sizes must be declared",
            "declare its length:  int32_t x_length;  double x[x_length];",
        ),
        (
            "struct T {\n geometry_msgs.Twist way[ ]; }",
            2,
            "Array sizes must be declared",
            "int32_t way_length;  geometry_msgs.Twist way[way_length];",
        ),
        (
            "struct T { byte a[n];\n int32_t n; }",
            1,
            "Unknown variable array index 'n'",
            "declare  int32_t n;  above the array",
        ),
        (
            "struct T { byte a[2][rows]; }",
            1,
            "Unknown variable array index 'rows'",
            "declare  int32_t rows;  above the array",
        ),
        (
            "struct T { double n; byte a[n]; }",
            1,
            "Array dimension 'n' must be an integer type",
            "declare  int32_t n;  above the array",
        ),
        ("struct T {\n byte a;\n byte a; }", 3, "Duplicate member name 'a'", ""),
        ("struct T {\n byte in;\n byte in; }", 3, "Duplicate member name 'in'", ""),
        ("struct T {\n uint8_t a;\n}", 2, "T: unknown type 'uint8_t'", "did you mean byte?"),
        ("struct T {\n doubel a;\n}", 2, "T: unknown type 'doubel'", "did you mean double?"),
        ("struct T {\n Strin a;\n}", 2, "T: unknown type 'Strin'", "did you mean std_msgs.String?"),
        ("struct T {\n flaot a;\n}", 2, "T: unknown type 'flaot'", "did you mean float?"),
        ("struct T {\n strin a;\n}", 2, "T: unknown type 'strin'", "did you mean string?"),
        ("struct T {\n int23_t a;\n}", 2, "T: unknown type 'int23_t'", "did you mean int32_t?"),
        ("struct T {\n flaot64 a;\n}", 2, "T: unknown type 'flaot64'", "did you mean double?"),
        ("struct T {\n point_t a;\n}", 2, "T: unknown type 'point_t'", "geometry_msgs.Point?"),
        ("struct T {\n int a;\n}", 2, "T: unknown type 'int'", "did you mean int32_t?"),
        ("struct T {\n geometry_msgs.Twst a; }", 2, "unknown type 'geometry_msgs.Twst'", "Twist?"),
        ("struct T {\n no_such.Thing a; }", 2, "unknown type 'no_such.Thing'", "name the folder"),
        ("struct T { T t; }", 0, "T contains itself", "only an array of variable size"),
        (
            "struct T { double x[1000000][1000]; }",
            0,
            "T is larger than LCM's",
            "give the array's size",
        ),
        ("\n\x00\x01", 2, "unexpected '\\x00'", "a .lcm file has words"),
        ('struct T {\n """ byte x; }', 2, "unexpected '\"'", "a .lcm file has words"),
    ],
)
def test_what_is_wrong_with_a_file_is_told_with_its_line(text, line, what, hint, write, types_of):
    folder = write({"p/T.lcm": text, "p/Good.lcm": "package p;\nstruct Good { byte x; }\n"})
    source = near(types_of(folder))
    assert set(source.fingerprints) == {"p/Good"}, "the others are not affected"
    (problem,) = source.problems
    assert (problem.file, problem.line) == (str(folder / "p/T.lcm"), line)
    assert what in problem.what
    assert hint in problem.hint


def test_a_broken_file_is_what_its_type_is_refused_for_even_if_lcmtools_has_one(write, types_of):
    known = registry(types_of(write({"std_msgs/String.lcm": "package std_msgs;\nstruct String {"})))
    with pytest.raises(Exception, match=r"String\.lcm:\d+: "):
        known.message_class("std_msgs/String")
    assert known.message_class("std_msgs/Header").__slots__ == ["seq", "stamp", "frame_id"]


def test_nothing_in_a_comment_is_run(write, types_of):
    evil = '// """\n// raise SystemExit\n/* """ + 1/0 + """ */\n'
    source = near(types_of(write({"T.lcm": f"{evil}struct T {{\n{evil} byte x; {evil} }}\n"})))
    assert (set(source.fingerprints), source.problems) == ({"T"}, [])


def test_service_pairs_are_found(write, types_of):
    text = "package p;\nstruct Go_Request { double x; }\nstruct Go_Response { boolean ok; }\n"
    known = registry(types_of(write({"Go.lcm": text})))
    assert known.service_names() == ["p/Go"]
    service = known.service_class("p/Go")
    assert service.Request.__slots__ == ["x"]
    assert service.Response is known.message_class("p/Go_Response")


def test_an_edited_file_counts_at_once(write, types_of):
    types = types_of(write({"T.lcm": "package p;\nstruct T { double x; }\n"}))
    known = registry(types)
    old = known.message_class("p/T")
    write({"T.lcm": "package p;\nstruct T { double y; }\n"})
    new = known.message_class("p/T")
    assert (old.__slots__, new.__slots__) == (["x"], ["y"])
    assert type_name(old) == type_name(new) == "p/T"


MANY = {f"T{n}.lcm": f"package p;\nstruct T{n} {{ double x; }}\n" for n in range(70)}


def forget(monkeypatch):
    """Forget what this process has parsed, as a new one would not know it."""
    for name in ("_sources", "_parsed"):
        monkeypatch.setattr(cache, name, {})
    monkeypatch.setattr(cache, "_read", set())


def test_what_is_parsed_once_is_kept(write, types_of, monkeypatch):
    folder = write(MANY)
    forget(monkeypatch)
    first = near(types_of(folder))
    assert len(first.fingerprints) == len(MANY)
    forget(monkeypatch)
    monkeypatch.setattr(cache, "parse_file", None)  # a call fails
    assert near(types_of(folder)) == first
    assert registry(types_of(folder)).message_class("p/T7").__slots__ == ["x"]


def test_of_many_files_only_a_new_one_is_parsed(write, types_of, monkeypatch):
    folder = write(MANY)
    near(types_of(folder))
    forget(monkeypatch)
    write({"T3.lcm": "package p;\nstruct T3 { double y; }\n"})
    parsed = []

    def parse(file):
        parsed.append(file.path.name)
        return parse_file(file)

    monkeypatch.setattr(cache, "parse_file", parse)
    assert registry(types_of(folder)).message_class("p/T3").__slots__ == ["y"]
    assert parsed == ["T3.lcm"]


def test_many_at_once_make_the_same(write, types_of, cache_folder, monkeypatch):
    folder = write(MANY)
    forget(monkeypatch)
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(near(types_of(folder)))) for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(20)
    assert len(found) == 4
    assert all(source == found[0] for source in found)
    kept = [path.name for path in (cache_folder / "lcmtools").iterdir()]
    assert kept == ["types.parsed"], "nothing half made stays"


@pytest.mark.parametrize("damage", [b"", b"{", marshal.dumps(("7", [])), marshal.dumps((1, 2, 3))])
def test_a_cache_that_somebody_has_damaged_is_made_anew(
    write, types_of, cache_folder, monkeypatch, damage
):
    folder = write(MANY)
    forget(monkeypatch)
    first = near(types_of(folder))
    (cache_folder / "lcmtools/types.parsed").write_bytes(damage)
    forget(monkeypatch)
    assert near(types_of(folder)) == first
    assert registry(types_of(folder)).message_class("p/T0").__slots__ == ["x"]


def test_without_a_cache_folder_types_work_all_the_same(write, tmp_path):
    folder = write({"T.lcm": "package p;\nstruct T { double x; }\n"})
    (tmp_path / "file").write_text("")
    environment = {"LCMTOOLS_TYPE_PATH": str(folder), "XDG_CACHE_HOME": str(tmp_path / "file")}
    types = UserTypes(environment, [], FINGERPRINTS)
    assert registry(types).message_class("p/T").__slots__ == ["x"]


def test_folder_that_is_not_there_is_told(types_of, tmp_path):
    source = near(types_of(tmp_path / "nope"))
    assert source.fingerprints == {}
    assert_says(str(source.problems[0].error()), f"{tmp_path}/nope: ", "no such folder")


def test_nothing_is_looked_for_where_nothing_is_said(tmp_path):
    assert UserTypes({}, [tmp_path], FINGERPRINTS).workspace() is None


def test_a_look_up_reads_the_environment_only_where_the_edge_provides_it(
    write, cache_folder, monkeypatch
):
    folder = write({"edge/Only.lcm": "package edge;\nstruct Only { double x; }\n"})
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache_folder))
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(folder))
    set_supply(None)
    with pytest.raises(UnknownType):
        message_class("edge/Only")
    provide_user_types()
    try:
        monkeypatch.delenv("LCMTOOLS_TYPE_PATH")
        assert message_class("edge/Only").__slots__ == ["x"]
        provide_user_types()
        with pytest.raises(UnknownType):
            message_class("edge/Only")
    finally:
        set_supply(None)
