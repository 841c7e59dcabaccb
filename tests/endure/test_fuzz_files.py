"""Damaged indexes, logs, types, YAML, XML and expressions: an error in one line at worst.

Each parser may refuse its input by the errors that users see, and by nothing else.
"""

from contextlib import suppress
from pathlib import Path

import pytest
from fixtures.mutation import mutated
from fixtures.strange_logs import MESSAGES, READERS, assert_readable, count_messages, write_log

from lcmtools.errors import LcmtoolsError
from lcmtools.formats.expression import Expression, ExpressionFault, Language
from lcmtools.formats.strict_xml import Element, read_xml
from lcmtools.formats.strict_yaml import read_file
from lcmtools.launch.file import read_file as read_launch_file
from lcmtools.launch.reading import make_plan
from lcmtools.packages.placed_type import comments
from lcmtools.packages.type_files import LcmFile
from lcmtools.packages.user_types import UserTypes
from lcmtools.types.fingerprints import FINGERPRINTS
from lcmtools.wire.log_index import SUFFIX

JSON = [b"[", b"{", b'"', b"null", b"1e999", b"-1", b"NaN", b'"\\ud800"', b"0", b"]", b"}"]
MARKUP = [b"<a>", b"</a>", b"&amp;", b"&#0;", b"<!--", b"-->", b"<![CDATA[", b"$(arg a)", b'"']
MAPPING = [b"&a ", b"*a", b"<<: *a\n", b"- ", b"{", b"}", b"[", b"]", b"|\n", b"!!binary ", b"'"]
LCM = [b"struct ", b"{", b"}", b"T0 ", b"[n]", b"/*", b"*/", b"//", b"const int8_t A=1;"]
ROS = [b"#", b"---\n", b"string ", b"int32[] ", b"T0 ", b"<=", b"=", b"'"]
CODE = [
    b"(",
    b")",
    b"**",
    b"and ",
    b"if ",
    b"x.",
    b"[0]",
    b"'",
    b"9" * 30,
    b"lambda ",
    b"max(",
    b",",
]


def test_a_log_with_a_damaged_index_has_its_messages(rounds, cli, tmp_path):
    path = tmp_path / "a.lcmlog"
    write_log(path)
    index = Path(f"{path}{SUFFIX}")
    whole = index.read_bytes()
    readers = list(READERS)
    for random in rounds(60):
        index.write_bytes(mutated(whole, random, JSON))
        assert count_messages(path) == MESSAGES
        assert_readable(cli, path, random.choice(readers))


def test_a_damaged_log_is_read_as_far_as_it_goes(rounds, cli, tmp_path):
    path = tmp_path / "a.lcmlog"
    write_log(path)
    whole = path.read_bytes()
    readers = list(READERS)
    for random in rounds(60):
        path.write_bytes(mutated(whole, random))
        assert_readable(cli, path, random.choice(readers))


TYPES = {
    "T.lcm": b"package own;\nstruct T0 { int32_t n; double x[n][3]; }\n"
    b"struct T { T0 a; T0 b[2]; const int32_t A = 1, B = 2; string name; } // end\n",
    "T.msg": b"int32 A=1\nstring B='text'\nfloat64[] x # [m]\nT0[3] rows\n",
}


@pytest.mark.parametrize(("name", "words"), [("T.lcm", LCM), ("T.msg", ROS)])
def test_a_damaged_type_is_refused_or_usable(name, words, rounds, tmp_path):
    place = tmp_path / "own" / "msg" / name
    place.parent.mkdir(parents=True)
    environment = {
        "LCMTOOLS_TYPE_PATH": str(tmp_path / "own"),
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
    }
    for random in rounds(40):
        content = mutated(TYPES[name], random, words)
        place.write_bytes(content)
        source = UserTypes(environment, [], FINGERPRINTS).workspace()
        assert source
        assert source.fingerprints or source.problems or source.enums or not content.strip()
        for problem in source.problems:
            assert str(problem.error())
        comments(LcmFile(str(place), content), "T")


YAML = b"""\
args: {robot: husky0, rate: 5}
env: &a {X: "1"}
nodes:
  - run: talker
    name: "t $(arg robot)"
    param: {kp: 0.5, list: [1, 2, 3]}
    remap: {chatter: news}
  - include: other.yaml
"""
XML = b"""\
<launch>
  <arg name="a" default="$(eval 1 + 2)"/>
  <group ns="x" if="true"><node pkg="lcmtools" type="talker" name="t" args="$(arg a) --rate 5">
    <remap from="chatter" to="news"/><param name="kp" value="0.5"/>
    <rosparam>{x: [1, 2], y: text}</rosparam>
  </node></group>
</launch>
"""


@pytest.mark.parametrize(
    ("suffix", "text", "words"), [(".yaml", YAML, MAPPING), (".launch", XML, MARKUP)]
)
def test_a_damaged_launch_file_is_a_plan_or_refused(suffix, text, words, rounds, tmp_path):
    path = tmp_path / f"a{suffix}"
    for random in rounds(400):
        path.write_bytes(mutated(text, random, words))
        refusable(lambda: make_plan([read_launch_file(path)], {}, "/", {}))


def test_damaged_yaml_and_xml_are_read_or_refused(rounds):
    for random in rounds(1000):
        text = mutated(YAML, random, MAPPING).decode("utf-8", "surrogateescape")
        refusable(lambda text=text: read_file(text, "a.yaml", merges_keys=True))
        markup = mutated(XML, random, MARKUP)
        refusable(lambda markup=markup: read_xml(markup, "a.xml", Element))


EXPRESSION = b"abs(m.x - 0.5) > 1e-3 and len(m.values[1:]) == 3 or max(m.values) ** 2 < y % 7"


class Values:
    """Some values of names."""

    def named(self, name):
        """Return the value of a name."""
        if name == "m":
            return self
        if name == "y":
            return 5
        raise LookupError(name)

    def attribute(self, owner, name):
        """Return a field."""
        if owner is self:
            return {"x": 0.25, "values": (1, 2, 3), "name": "text"}[name]
        raise LookupError(name)


def test_a_damaged_expression_is_evaluated_or_refused(rounds):
    language = Language("filter", "m.x", "fields are", 1000, {}, has_fields=True, has_choices=True)
    for random in rounds(1500):
        text = mutated(EXPRESSION, random, CODE).decode("utf-8", "replace")
        with suppress(LcmtoolsError, ExpressionFault):
            Expression(text, language).value(Values())


def refusable(work):
    """Do some work, which may raise the errors that users see."""
    with suppress(LcmtoolsError):
        work()
