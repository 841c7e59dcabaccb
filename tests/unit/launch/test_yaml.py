"""YAML launch files: the same meaning as XML's, strict keys, and each mistake with its line."""

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import InvalidFile
from lcmtools.launch.plan import Output

WHOLE = """\
args:
  robot: husky0
  gain: {default: 1e-3, doc: effort per speed error}
env: {COLOR: on}
nodes:
  - run: simple_controller
    name: driver
    ns: $(arg robot)
    remap: {controlled_velocity: velocity_cmd}
    param: {kp: $(arg gain), names: [a, 'on', 2], text: "2", deep: {er: true}}
    env: {X: 1}
    respawn: true
    respawn_delay: 2
    output: log
  - run: air_lab0 evaluate_controller
    args: [--flag, a b]
    if: false
  - run: sim --world husky
    name: morse
    required: true
groups:
  - ns: other
    unless: $(eval robot == 'husky1')
    remap: {chatter: news}
    nodes:
      - run: talker
      - exec: cat -n
        launch_prefix: nice
        stdin: true
"""


@pytest.fixture
def yaml(plan):
    """``yaml(text)``: the plan of a file a.yaml."""

    def make(text, **options):
        return plan(text, suffix=".yaml", **options)

    return make


def test_whole_file_means_what_it_says(yaml):
    driver, morse, talker, cat = yaml(WHOLE).nodes
    assert driver.name == "/husky0/driver"
    assert driver.command == (
        *("lcmtools", "run", "lcmtools", "simple_controller", "__ns:=/husky0", "__name:=driver"),
        *("controlled_velocity:=velocity_cmd", "_kp:=1e-3", '_names:=[a, "on", 2]'),
        *('_text:="2"', "_deep/er:=true"),
    )
    assert driver.environment == {"COLOR": "on", "X": "1"}
    assert (driver.respawn, driver.respawn_delay, driver.output) == (True, 2.0, Output.LOG)
    assert (driver.place, morse.place) == ("a.yaml:6", "a.yaml:18")
    assert morse.command[2:] == ("sim", "--world", "husky", "__ns:=/", "__name:=morse")
    assert (morse.is_required, morse.output) == (True, Output.BOTH)
    assert talker.command[2:] == ("talker", "__ns:=/other", "__name:=talker", "chatter:=news")
    assert (cat.name, cat.command) == ("/other/cat", ("nice", "cat", "-n"))
    assert cat.environment == {"COLOR": "on", "LCMTOOLS_NAMESPACE": "/other"}
    assert cat.takes_terminal


def test_arguments_and_namespace_are_given(yaml):
    driver, _ = yaml(WHOLE, namespace="/lab", robot="husky1").nodes
    assert driver.name == "/lab/husky1/driver"


def test_keys_count_for_the_others_wherever_they_stand(yaml):
    (node,) = yaml("nodes: [{run: talker}]\nremap: {a: $(arg b)}\nargs: {b: c}\n").nodes
    assert node.command[-1] == "a:=c"


@pytest.mark.parametrize(
    "text", ["include: b.yaml", "include: [b.yaml]", "include:\n  - {file: b.yaml, args: {n: t}}"]
)
def test_include_takes_a_file_or_a_list(yaml, folder, text):
    (folder / "b.yaml").write_text("args: {n: t}\nnodes: [{run: talker, name: $(arg n)}]\n")
    assert [node.name for node in yaml(text).nodes] == ["/t"]


def test_script_is_run_by_python_and_gets_its_names(yaml, folder):
    (folder / "node.py").touch()
    (node,) = yaml("nodes: [{run: ./node.py, ns: a}]").nodes
    assert node.name == "/a/node"
    assert node.command[3:] == (f"{folder}/node.py", "__ns:=/a", "__name:=node")


def test_program_that_is_executable_is_run_itself(yaml, folder):
    program = folder / "node"
    program.write_text("#!/bin/sh\n")
    text = "nodes: [{run: ./node}]"
    with raises_saying(InvalidFile, "a.yaml:1", "/node", "not executable", "chmod"):
        yaml(text)
    program.chmod(0o755)
    assert yaml(text).nodes[0].command[:2] == (str(program), "__ns:=/")


@pytest.mark.parametrize(
    ("text", "line", "reason"),
    [
        ("", 1, "the file is empty"),
        ("nodes: [", 1, "not YAML: "),
        ("nodes:\n  - run: a\n   ns: b", 3, "; indent the keys of an entry equally"),
        ("nodes: [{run: sh -c x}]", 1, "write a program as  exec: sh,  args: -c x"),
        ("a: b: c", 1, "not YAML: mapping values are not allowed in this context"),
        ("- run: talker", 1, "the file: expected names and values"),
        ("node:\n  - run: talker", 1, "there is no key 'node' in the file; did you mean nodes?"),
        ("nodes: {run: talker}", 1, "nodes: expected a list; begin each of its parts with '- '"),
        (
            "nodes:\n  - run: talker\n    respaw: true",
            3,
            "there is no key 'respaw' in a node; did you mean respawn?",
        ),
        ("nodes:\n  - name: x", 2, "'run' is missing in a node"),
        ("nodes:\n  - talker", 2, "a node: expected names and values; for example  run: talker"),
        ("nodes:\n  - {run: talker, remap: [a]}", 2, "names and values; for example  chatter: ne"),
        ("nodes:\n  - {pkg: a, type: b}", 2, "no key 'pkg' in a node; did you mean run: PACKAGE"),
        ("nodes:\n  - {run: talker, namespace: a}", 2, "in a node; did you mean ns?"),
        ("launch: []", 1, "there is no key 'launch' in the file; did you mean nodes?"),
        ("nodes:\n  - {run: talker, ns: '${robot}'}", 2, "; write an argument as $(arg NAME)"),
        ("args: {r: a}\nnodes: [{run: talker, ns: $(r)}]", 2, "'$(r ...)'; write $(arg r)"),
        ("nodes:\n  - run: [talker]", 2, "run: expected one word or number"),
        ("nodes:\n  - {run: talker, run: sim}", 2, "'run' is given twice"),
        ("nodes:\n  - {run: talker, exec: ls}", 2, "a node has only one of run and exec"),
        ("nodes:\n  - run: talkr", 2, "there is no node 'talkr'; did you mean talker?"),
        ("nodes:\n  - run: nopkg talker", 2, "there is no package 'nopkg'"),
        ("nodes:\n  - exec: nosuchprogram", 2, "there is no program 'nosuchprogram' on the PATH"),
        ("nodes:\n  - exec: ls\n    param: {a: 1}", 2, "a program started by exec takes no remaps"),
        ("nodes:\n  - {run: talker}\n  - {run: talker}", 3, "the node /talker is already defined"),
        ("nodes:\n  - {run: talker, cwd: nope}", 2, "there is no folder"),
        ("args:\n  a: {dflt: 1}", 2, "there is no key 'dflt' in a; did you mean default?"),
        ("args:\n  a:\nnodes: []", 2, "the argument 'a' has no value; type a:=VALUE"),
        ('nodes:\n  - {run: talker, args: "a\\0b"}', 2, "'a\\x00b' has a character that a"),
        ('include: "a\\0b"', 1, "'a\\x00b' is not a path"),
        ("include: ~nobody_here/a.yaml", 1, "'~nobody_here/a.yaml' is not a path"),
        ("include: " + "x" * 300, 1, "File name too long"),
        ("nodes:\n  - run: '  '", 2, "'run' is empty in node"),
        ("nodes:\n  - exec: '  '", 2, "'exec' is empty in node"),
        ("nodes:\n  - run: ./nope", 2, "there is no program"),
        ("x: &a [*a, *a]", 1, "unknown alias '*a'"),
        ("param: &a {b: *a}", 1, "unknown alias '*a'"),
    ],
)
def test_mistake_is_named_with_its_line(yaml, text, line, reason):
    with pytest.raises(InvalidFile) as caught:
        yaml(text)
    assert str(caught.value).startswith(f"a.yaml:{line}: "), caught.value
    assert reason in str(caught.value)


def test_parameter_that_is_empty_is_given_and_not_left_out(yaml):
    (node,) = yaml("nodes: [{run: talker, param: {a: '', b: }}]").nodes
    assert node.command[-2:] == ("_a:=''", "_b:=''")


def test_aliases_cannot_fill_the_memory(yaml):
    rows = ["param:", "  a0: &a0 {x: 1, y: 2}"]
    rows += [f"  a{i}: &a{i} {{x: *a{i - 1}, y: *a{i - 1}}}" for i in range(1, 40)]
    with raises_saying(InvalidFile, "aliases", "100000"):
        yaml("\n".join(rows))


def test_deep_nesting_is_refused_and_no_crash(yaml):
    with raises_saying(InvalidFile, "nested", "100"):
        yaml("[" * 5000)


def test_ros_2_launch_program_is_told_from_yaml(plan):
    with pytest.raises(InvalidFile, match=r"a\.launch\.py is a program"):
        plan("def generate_launch_description(): pass", suffix=".launch.py")
