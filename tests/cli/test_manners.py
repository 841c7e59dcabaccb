"""The manners that show before there is a bus, over the whole tree of commands."""

import click
import pytest

from lcmtools.cli.declare import duration
from lcmtools.cli.main import main, root

Path = tuple[str, ...]


def walk(command, path=()):
    """The words after "lcmtools" of every command that help lists."""
    yield path, command
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            below = command.get_command(context, name)
            assert below is not None
            yield from walk(below, (*path, name))


TREE = dict(walk(root))
GROUPS = [path for path, command in TREE.items() if isinstance(command, click.Group)]
LEAVES = [path for path in TREE if path not in GROUPS]
OPTIONS = [
    (path, option)
    for path, command in TREE.items()
    for option in command.params
    if isinstance(option, click.Option)
]
# but for those whose value may be left out: there the next word is an option
VALUED = [
    (path, option)
    for path, option in OPTIONS
    if not option.is_flag and not isinstance(option.flag_value, str)
]
Captured = pytest.CaptureFixture[str]


def named(path):
    return " ".join(("lcmtools", *path))


def wrong_usage(path):
    """The exit code of wrong usage: wtf's other codes are those of what it finds."""
    return 64 if path in (("wtf",), ("doctor",)) else 2


def misspelt():
    """Commands with an option, and the option without its last letter, which is no other one."""
    for path, option in OPTIONS:
        command = TREE[path]
        takes_others = command.context_settings.get("ignore_unknown_options")
        known = {name for other in command.params for name in other.opts}
        for name in option.opts:
            is_long = name.startswith("--") and len(name) > 5
            if is_long and name[:-1] not in known and not (option.hidden or takes_others):
                yield path, name, name[:-1]


def test_unknown_option_is_one_line_and_exit_code_2(capsys):
    for path in TREE:
        assert main([*path, "--verbse-bogus"]) == wrong_usage(path), path
        out, error = capsys.readouterr()
        assert (out, error.count("\n")) == ("", 1), path
        assert error.startswith(f"{named(path)}: "), path


def test_misspelt_command_is_answered_with_the_one_that_was_meant(capsys):
    for path in GROUPS:
        command = TREE[path]
        assert isinstance(command, click.Group)
        for name in command.list_commands(click.Context(command)):
            if len(name) > 3:
                wrong = f"{name[1]}{name[0]}{name[2:]}"
                assert main([*path, wrong]) == 2
                error = capsys.readouterr().err
                start = f"{named(path)}: no such command '{wrong}'; did you mean '"
                assert error.startswith(start), path


def test_misspelt_option_is_answered_with_the_one_that_was_meant(capsys):
    cases = list(misspelt())
    assert len(cases) > 250
    assert len({path for path, _, _ in cases}) > len(LEAVES) * 0.9
    for path, right, wrong in cases:
        assert main([*path, wrong]) == wrong_usage(path), (path, wrong)
        error = capsys.readouterr().err
        assert wrong in error, (path, wrong)
        assert right in error.replace(wrong, "", 1), (path, wrong, error)


def test_colour_and_debug_can_be_said_after_every_command():
    for path, command in TREE.items():
        names = {name for parameter in command.params for name in parameter.opts}
        assert {"--color", "--no-color", "--debug"} <= names, path


def test_help_is_plain_ascii_and_bears_a_terminal_of_40_columns(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setenv("FORCE_COLOR", "1")
    for path in TREE:
        assert main([*path, "--help"]) == 0
        text = capsys.readouterr().out
        assert text.isascii(), path
        assert text.isprintable() or set(filter(str.isspace, text)) == {"\n", " "}, path
        summary = text.split("\n\n")[1]
        assert max(map(len, summary.splitlines())) <= 50, path  # click wraps no narrower


def test_help_command_says_the_same_as_help_option(capsys):
    for path in TREE:
        assert main([*path, "--help"]) == 0
        text = capsys.readouterr().out
        assert main(["help", *path]) == 0
        assert capsys.readouterr().out == text, path


def test_help_needs_no_settings_that_can_be_read(capsys, broken_settings):
    del broken_settings
    for path in LEAVES:
        assert main([*path, "--help"]) == 0, path
        assert capsys.readouterr().err == "", path


@pytest.fixture
def broken_settings(tmp_path, monkeypatch):
    """A settings file that is no YAML."""
    import pathlib

    file = pathlib.Path(str(tmp_path)) / "lcmtools" / "config.yaml"
    file.parent.mkdir()
    file.write_text("domain: [\n")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))


def test_value_of_an_option_may_begin_with_a_minus():
    """Such a word is not taken for an option; it may make no sense."""
    for path, option in VALUED:
        command = TREE[path]
        parser = command.make_parser(click.Context(command, **command.context_settings))
        values, _, _ = parser.parse_args([option.opts[0], "-1"])
        assert values[option.name] in ("-1", ["-1"]), path


def test_time_spans_are_said_in_milliseconds_seconds_and_minutes():
    spans = [row for row in VALUED if row[1].name in ("timeout", "wait", "duration", "period")]
    assert len(spans) > 20
    for path, option in spans:
        context = click.Context(TREE[path])
        read = [option.type_cast_value(context, text) for text in ("500ms", "2s", "1m", "3")]
        assert read == [0.5, 2.0, 60.0, 3.0], path
        assert option.name != "timeout" or option.envvar == "LCMTOOLS_TIMEOUT", path


def test_a_duration_says_what_it_may_be():
    with pytest.raises(click.BadParameter, match="write 500ms, 2s or 1m"):
        duration("soon")


def test_root_help_names_exit_codes_and_environment(capsys):
    main(["--help"])
    text = capsys.readouterr().out
    for code in (
        "0 success",
        "1 failure",
        "2 wrong usage",
        "3 an extra",
        "4 nothing received",
        "130",
        "143",
    ):
        assert code in text
    for variable in ("LCM_DEFAULT_URL", "LCMTOOLS_DOMAIN", "LCMTOOLS_NAMESPACE", "NO_COLOR"):
        assert variable in text


def test_debug_after_the_command_shows_the_traceback(monkeypatch):
    def fail():
        raise ZeroDivisionError

    monkeypatch.setattr("lcmtools.cli.msg.type_names", fail)
    monkeypatch.setenv("LCMTOOLS_DEBUG", "")
    with pytest.raises(ZeroDivisionError):
        main(["msg", "list", "--debug"])


def test_failure_of_a_command_with_json_is_told_in_json(capsys, bus_url):
    import json

    assert main(["info", "--json", "/nothing", "--lcm-url", bus_url]) == 1
    assert json.loads(capsys.readouterr().err) == {
        "command": "lcmtools info",
        "error": "unknown topic /nothing",
        "hint": "lcmtools list shows the topics",
        "exit_code": 1,
    }


def test_wrong_usage_is_told_in_words_even_with_json(capsys):
    assert main(["list", "--json", "--wait", "soon"]) == 2
    assert capsys.readouterr().err.startswith("lcmtools list: invalid value for '--wait'")
