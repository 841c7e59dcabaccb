"""ROS 1's XML launch files: what each tag means, and each mistake with its line."""

import pytest
from fixtures.says import assert_says, raises_saying

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.launch.plan import Output

TALKER = '<node pkg="lcmtools" type="talker" name="t"/>'


def words(plan):
    """The only node's command line behind its program."""
    (node,) = plan.nodes
    return node.command[3:]


def test_labs_file_becomes_one_node_with_its_remap(xml):
    plan = xml(
        """<!-- a node of the package air_lab0 -->
        <node name="husky_simple_controller" pkg="air_lab0"
           type="simple_controller">
        <remap from="controlled_velocity" to="velocity_cmd" />
        </node>""",
        namespace="/husky0",
    )
    (node,) = plan.nodes
    assert node.name == "/husky0/husky_simple_controller"
    assert node.command_line() == (
        "lcmtools run lcmtools simple_controller __ns:=/husky0 __name:=husky_simple_controller"
        " controlled_velocity:=velocity_cmd"
    )
    assert node.place == "a.launch:3"
    (note,) = plan.notes
    assert_says(note, "a.launch:3", "lcmtools' own simple_controller")


def test_attributes_of_a_node_are_read(xml):
    tag = TALKER.replace(
        "/>",
        ' ns="x" args="--rate 5 \'a b\'" respawn="true" respawn_delay="2.5" output="screen"'
        ' launch-prefix="nice -n 5"/>',
    )
    (node,) = xml(tag).nodes
    assert node.command == (
        *("nice", "-n", "5", "lcmtools", "run", "talker", "--rate", "5", "a b"),
        *("__ns:=/x", "__name:=t"),
    )
    assert (node.respawn, node.respawn_delay, node.output) == (True, 2.5, Output.SCREEN)
    assert node.takes_input
    assert not node.is_required


def test_namespaces_go_into_each_other_and_a_full_one_stands_alone(xml):
    plan = xml(
        f"""<group ns="a"><group ns="b">{TALKER}</group>
        <node pkg="lcmtools" type="talker" name="t" ns="/c"/></group>""",
        namespace="/husky0",
    )
    assert [node.name for node in plan.nodes] == ["/husky0/a/b/t", "/c/t"]


def test_remaps_and_variables_hold_for_what_is_below_and_end_with_their_group(xml):
    plan = xml(
        """<remap from="a" to="b"/>
        <group><remap from="a" to="c"/><env name="X" value="1"/>
          <node pkg="lcmtools" type="talker" name="t1"><remap from="d" to="e"/></node></group>
        <node pkg="lcmtools" type="talker" name="t2"/>"""
    )
    first, second = plan.nodes
    assert first.command[5:] == ("a:=c", "d:=e")
    assert second.command[5:] == ("a:=b",)
    assert (first.environment, second.environment) == ({"X": "1"}, {})


def test_parameters_go_to_the_nodes_that_would_find_them(xml):
    plan = xml(
        """<param name="use_sim_time" value="true"/>
        <param name="/husky0/t/kp" value="3"/>
        <param name="~below" value="1"/>
        <group ns="husky0">
          <param name="~rate" value="5"/>
          <param name="mass" value="50"/>
          <node pkg="lcmtools" type="talker" name="t"><param name="ki" type="double" value="2"/>
            <rosparam>
              gains: {p: 1, names: [a, 'on']}
            </rosparam></node>
        </group>
        <node pkg="lcmtools" type="talker" name="t"/>"""
    )
    first, second = (set(node.command[5:]) for node in plan.nodes)
    assert first == {
        *("_use_sim_time:=true", "_kp:=3", "_below:=1", "_rate:=5", "_mass:=50", "_ki:=2.0"),
        *("_gains/p:=1", '_gains/names:=[a, "on"]'),
    }
    assert second == {"_use_sim_time:=true", "_below:=1"}


def test_nearer_parameter_wins(xml):
    plan = xml(
        """<param name="rate" value="1"/><param name="a/rate" value="2"/>
        <group ns="a"><node pkg="lcmtools" type="talker" name="t"/></group>"""
    )
    assert words(plan)[2:] == ("_rate:=2",)


def test_type_of_a_parameter_is_kept_as_text_or_checked(xml):
    node = TALKER.replace("/>", ">{}</node>")
    plan = xml(node.format('<param name="a" type="str" value="2"/>'))
    assert words(plan)[2:] == ('_a:="2"',)
    with raises_saying(InvalidFile, "a.launch:2", "param a", "integer", "'2.5'"):
        xml(node.format('<param name="a" type="int" value="2.5"/>'))


def test_rosparam_reads_files_and_puts_arguments_in(xml, folder):
    (folder / "gains.yaml").write_text("kp: $(arg p)\n")
    plan = xml(
        TALKER.replace(
            "/>",
            '><rosparam command="load" ns="g" file="$(dirname)/gains.yaml" subst_value="true"/>'
            "</node>",
        ).replace("<node", '<arg name="p" default="7"/><node')
    )
    assert words(plan)[2:] == ("_g/kp:=7",)


def test_textfile_is_a_parameter_and_a_command_is_left_out_with_a_note(xml, folder):
    (folder / "robot.urdf").write_text("<robot/>\n")
    plan = xml(
        f"""<param name="urdf" textfile="robot.urdf"/>
        <param name="x" command="rm -rf /"/>{TALKER}"""
    )
    assert words(plan)[2:] == ('_urdf:="<robot/>\\n"',)
    (note,) = plan.notes
    assert_says(note, "a.launch:3", "command", "left out")


def test_if_and_unless_decide(xml):
    tags = "".join(
        f'<group {kind}="{text}"><node pkg="lcmtools" type="talker" name="{kind}_{i}"/></group>'
        for kind in ("if", "unless")
        for i, text in enumerate(("1", "true", "True", "0", "false", "$(eval 1 > 2)"))
    )
    assert [node.name for node in xml(tags).nodes] == [
        *("/if_0", "/if_1", "/if_2"),
        *("/unless_3", "/unless_4", "/unless_5"),
    ]


def test_arguments_have_defaults_values_and_what_is_given(xml):
    tags = f"""<arg name="robot" default="husky0"/><arg name="full" value="/$(arg robot)"/>
    <group ns="$(arg full)">{TALKER}</group>"""
    assert xml(tags).nodes[0].name == "/husky0/t"
    assert xml(tags, robot="husky1").nodes[0].name == "/husky1/t"
    with raises_saying(InvalidFile, "a.launch:2", "'full'", "fixed"):
        xml(tags, full="x")
    with raises_saying(UsageError, "robto:=x", "a.launch", "did you mean robot?"):
        xml(tags, robto="x")


def test_include_passes_arguments_namespace_and_remaps(xml, folder):
    (folder / "sub").mkdir()
    (folder / "sub" / "b.launch").write_text(
        '<launch><arg name="n"/><arg name="m" default="5"/><include file="c.yaml"/>'
        '<node pkg="lcmtools" type="talker" name="t$(arg n)$(arg m)"/></launch>'
    )
    (folder / "sub" / "c.yaml").write_text("nodes:\n  - run: listener\n")
    plan = xml(
        """<arg name="m" default="9"/><remap from="a" to="b"/>
        <include file="$(dirname)/sub/b.launch" ns="x"><arg name="n" value="1"/>
        <env name="E" value="2"/></include>"""
    )
    assert [node.name for node in plan.nodes] == ["/x/listener", "/x/t15"]
    assert {node.command[-1] for node in plan.nodes} == {"a:=b"}
    assert plan.nodes[1].environment == {"E": "2"}
    assert plan.files == tuple(str(folder / n) for n in ("a.launch", "sub/b.launch", "sub/c.yaml"))


def test_argument_that_an_include_lacks_is_told_where_it_is_declared(xml, folder):
    (folder / "b.launch").write_text('<launch>\n<arg name="n" doc="how many"/></launch>')
    with pytest.raises(InvalidFile) as caught:
        xml('<include file="b.launch"/>')
    assert_says(str(caught.value), "b.launch:2", "'n'", "how many", "include")
    with raises_saying(InvalidFile, "a.launch:2", "b.launch", "'m'", "n"):
        xml('<include file="b.launch"><arg name="m" value="1"/></include>')


def test_include_with_all_arguments_passes_them(xml, folder):
    (folder / "b.launch").write_text(
        '<launch><arg name="m" default="5"/><arg name="k" value="3"/>'
        '<node pkg="lcmtools" type="talker" name="t$(arg m)$(arg k)"/></launch>'
    )
    plan = xml(
        """<arg name="m" default="9"/><arg name="k" default="8"/><arg name="other" default="1"/>
        <include file="b.launch" pass_all_args="true"/>"""
    )
    assert plan.nodes[0].name == "/t93"


def test_labs_world_is_included_by_its_package(xml):
    plan = xml(
        """<include file="$(find gazebo_ros)/launch/empty_world.launch">
        <arg name="world_name" value="husky"/><arg name="paused" value="true"/></include>"""
    )
    assert plan.nodes[0].command_line() == (
        "lcmtools run sim --world husky --rate 1 --paused --view __ns:=/ __name:=gazebo"
    )


def test_what_means_nothing_is_noted_with_its_line(xml):
    plan = xml(
        """<machine name="m" address="far"/>
        <nodee/>
        <test pkg="x" type="y" test-name="z"/>
        <node pkg="lcmtools" type="talker" name="t" respaw="true" clear_params="true"/>"""
    )
    tag, machine, attribute, no_effect = plan.notes
    assert_says(tag, "a.launch:3", "'nodee'", "launch", "did you mean node?")
    assert_says(machine, "a.launch:2", "machine", "no effect")
    assert_says(attribute, "a.launch:5", "node", "'respaw'", "did you mean respawn?")
    assert_says(no_effect, "a.launch:5", "clear_params", "no effect")
    assert len(plan.nodes) == 1


def test_parameters_that_no_node_gets_are_named(xml):
    plan = xml(
        f"""<rosparam>
        t: {{rate: 1}}
        everywhere: 2
        ctl: {{a: 1, b: 2, c: 3, d: {{e: 4}}, f: 5}}
        </rosparam><param name="lost/p" value="6"/>{TALKER}"""
    )
    assert words(plan)[2:] == ("_everywhere:=2", "_rate:=1")
    (note,) = plan.notes
    assert_says(note, "no node", "/ctl/a, /ctl/b, /ctl/c, /ctl/d/e, /ctl/f and 1 more")


def test_names_behind_two_dashes_would_not_be_taken_and_stand_before_them(xml):
    plan = xml(TALKER.replace("/>", ' args="-- x"/>'))
    assert words(plan) == ("__ns:=/", "__name:=t", "--", "x")


@pytest.mark.parametrize(
    ("tags", "line", "reason"),
    [
        ('<node pkg="lcmtools" type="talker"/>', 2, "'name' is missing in node"),
        ('<node pkg="" type="talker" name="t"/>', 2, "'pkg' is empty in node"),
        ('<node pkg="lcmtools" name="t"/>', 2, "'type' is missing in node"),
        (
            '<node pkg="lcmtools" type="talker" name="a/b"/>',
            2,
            "does not start with a digit; its namespace is given by the attribute ns",
        ),
        ('<node pkg="nopkg" type="x" name="t"/>', 2, "there is no package 'nopkg'"),
        (
            '\n<node pkg="lcmtools" type="talkr" name="t"/>',
            3,
            "there is no node 'talkr' in the package lcmtools; did you mean talker?",
        ),
        (TALKER.replace("/>", ' respawn="maybe"/>'), 2, "'respawn' must be true or false"),
        (TALKER.replace("/>", ' respawn_delay="-1"/>'), 2, "'respawn_delay' must be between 0 and"),
        (TALKER.replace("/>", ' respawn_delay="1 h"/>'), 2, "must be a number, not '1 h'"),
        (TALKER.replace("/>", ' output="file"/>'), 2, "'output' must be one of screen, log, both"),
        (TALKER.replace("/>", ' args="\'"/>'), 2, "a quote is not closed"),
        (
            TALKER.replace("/>", ' respawn="true" required="true"/>'),
            2,
            "a node cannot be both required and respawned",
        ),
        (TALKER.replace("/>", ' if="1" unless="0"/>'), 2, "node has both 'if' and 'unless'"),
        (f"{TALKER}\n{TALKER}", 3, "the node /t is already defined by a.launch:2"),
        ('<remap from="a"/>', 2, "'to' is missing in remap"),
        ('<node package="a" type="b" name="c"/>', 2, "in node; there is no attribute 'package'"),
        ('<node pkg="a" exec="b" name="c"/>', 2, "the program of pkg is named by type"),
        ('<remap from="a b" to="c"/>', 2, "'a b' is not a legal name"),
        ('<arg name="a"/>', 2, "the argument 'a' has no value; type a:=VALUE"),
        ('<arg name="a" value="1" default="2"/>', 2, "has both 'value' and 'default'"),
        ('<arg name="a" value="1"/><arg name="a" value="1"/>', 2, "is declared twice"),
        ('<group ns="$(arg x)"/>', 2, "there is no argument 'x'"),
        ('<group ns="~x"/>', 2, "'~x' is private"),
        ('<group if="2"/>', 2, "'if' must be true or false, not '2'"),
        ('<include file="nope.launch"/>', 2, "cannot read nope.launch: No such file"),
        ('<include file="a.launch"/>', 2, "files include each other more than 50 levels deep"),
        ('<param name="a"/>', 2, "param a needs one of: value, textfile, command, binfile"),
        ('<param name="a" value="1" type="number"/>', 2, "'number' is not a type"),
        ('<param name="a" textfile="nope"/>', 2, "cannot read"),
        ("<rosparam>[1, 2]</rosparam>", 2, "rosparam: expected names and values"),
        ('<env name="A"/>', 2, "'value' is missing in env"),
    ],
)
def test_mistake_is_named_with_its_line(xml, tags, line, reason):
    with pytest.raises(InvalidFile) as caught:
        xml(tags)
    assert str(caught.value).startswith(f"a.launch:{line}: ")
    assert reason in str(caught.value)


def test_file_that_includes_itself_in_many_groups_is_refused(xml):
    inside = '<include file="a.launch"/>'
    with raises_saying(InvalidFile, "a.launch", "nested too deeply"):
        xml("<group>" * 45 + inside + "</group>" * 45)


BAD = "not XML: not well-formed (invalid token)"


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "a.launch:1: the file is empty"),
        ("<launch>\n<node\n</launch>", f"a.launch:3: {BAD}; is the tag of line 2 closed by '>'?"),
        ("<launch>\n<node a=b/>\n</launch>", f"a.launch:2: {BAD}; write values in quotes, as in"),
        ('<launch>\n<node a="b && c"/>\n</launch>', f"a.launch:2: {BAD}; write & as &amp;"),
        ('<launch>\n<node a="b<c"/>\n</launch>', f"a.launch:2: {BAD}; write < in a value as &lt;"),
        ('<launch>\n<!-- a -- b -->\n<n a="--x"/></launch>', f"a.launch:2: {BAD}; a comment can"),
        ("<launch>", "a.launch:1: not XML: no element found; is the <launch> of line 1 closed?"),
        (
            "<launch>\n<node>\n</launch>",
            "a.launch:3: not XML: mismatched tag; is the <node> of line 2 closed? </node>, or",
        ),
        ("<robot/>", "a.launch:1: expected <launch>, got <robot>; put all into <launch></launch>"),
        (
            "<launch>\n<node name=\u201cx\u201d/></launch>",
            "a.launch:2: not XML: not well-formed (invalid token); write straight quotes",
        ),
        ("1 <launch>\n2 </launch>", "a.launch:1: not XML: syntax error; remove the line numbers"),
        (
            '<!DOCTYPE launch [<!ENTITY a "b">]>\n<launch/>',
            "a.launch:1: a document type (<!DOCTYPE>) is not supported; remove it",
        ),
        ("<launch>" + "<group>" * 100, "a.launch:1: nested more than 50 levels deep"),
        ('<?xml version="1.0" encoding="klingon"?><launch/>', "a.launch:1: not XML: unknown enc"),
    ],
)
def test_text_that_is_no_launch_file_is_refused(plan, text, error):
    with pytest.raises(InvalidFile) as caught:
        plan(text)
    assert str(caught.value).startswith(error)
