"""The user's settings file: read strictly, each mistake with its line; and which source counts."""

from pathlib import Path

import pytest

from lcmtools.bus.url import choose_url
from lcmtools.errors import InvalidFile, UsageError
from lcmtools.settings import (
    NO_FILE,
    SETTINGS,
    UserFile,
    lookup,
    parse_duration,
    read_user_file,
    user_path,
    usual_namespace,
)

_KNOWN = "there are lcm_url, domain, namespace, color, timeout"
_LEGAL = "names are made of letters, digits, '_' and '/', and start with a letter, '/' or '~'"


@pytest.fixture
def write(tmp_path):
    """Writes the user's file; gives an environment that leads to it."""

    def do(text):
        path = tmp_path / "lcmtools" / "config.yaml"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return {"XDG_CONFIG_HOME": str(tmp_path)}

    return do


def test_the_file_is_where_xdg_says():
    assert str(user_path({"XDG_CONFIG_HOME": "/c", "HOME": "/h"})) == "/c/lcmtools/config.yaml"
    assert str(user_path({"HOME": "/h"})) == "/h/.config/lcmtools/config.yaml"
    assert str(user_path({"XDG_CONFIG_HOME": "relative", "HOME": "/h"})).startswith("/h/")
    assert user_path({}) is None


def test_without_a_file_nothing_is_said(tmp_path):
    assert read_user_file({}) == NO_FILE
    assert read_user_file({"HOME": str(tmp_path)}).values == {}
    (tmp_path / ".config").touch()  # a file where a folder is looked for
    assert read_user_file({"HOME": str(tmp_path)}).values == {}


@pytest.mark.parametrize("text", ["", "# nothing yet\n", "---\n", "{}\n", "domain:\n"])
def test_a_file_that_says_nothing_is_no_mistake(text, write):
    assert read_user_file(write(text)).values == {}


def test_values_are_the_text_as_written_with_their_lines(write):
    file = read_user_file(write("# mine\ndomain: 007\n\nnamespace: on\n"))
    assert file.values == {"domain": "007", "namespace": "on"}
    assert file.lines == {"domain": 2, "namespace": 4}
    assert file.source("namespace") == f"{file.path}:4"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("domian: 3\n", ":1: there is no setting 'domian'; did you mean domain?"),
        ("a: 1\n", f":1: there is no setting 'a'; {_KNOWN}"),
        ("domain: 3\ndomain: 4\n", ":2: not YAML: 'domain' is given twice; leave one of them out"),
        ("\ndomain: [3]\n", ":2: domain: expected one value; write lines as  domain: 3"),
        (
            "color: allways\n",
            ":1: color: 'allways' is not one of auto, always, never; did you mean always?",
        ),
        ("timeout: soon\n", ":1: timeout: 'soon' is not a duration; write 500ms, 2s or 1m"),
        ("namespace: 1a\n", f":1: namespace: '1a' is not a legal name; {_LEGAL}"),
        ("- domain\n", ":1: expected settings with their values; write lines as  domain: 3"),
        ("domain\n", ":1: expected settings with their values; write lines as  domain: 3"),
        ("domain: 3\ncolor: 'never\n", ":2: not YAML: this quote is not closed"),
        ("\x00", ":1: not YAML: the character U+0000 is not allowed"),
        (
            "a: 1\n---\nb: 2\n",
            ":3: another document begins, but only one is expected; remove the --- line",
        ),
        (
            "? [a]\n: 1\n",
            ":1: not YAML: a key must be a word; put text that begins with '{{' in quotes",
        ),
    ],
)
def test_a_mistake_is_named_with_its_line(text, complaint, write):
    environment = write(text)
    with pytest.raises(InvalidFile) as caught:
        read_user_file(environment)
    assert str(caught.value) == f"{user_path(environment)}{complaint}"


def test_what_is_no_text_is_refused(write):
    environment = write("")
    path = user_path(environment)
    path.write_bytes(b"color: \xff\n")
    with pytest.raises(InvalidFile, match="it is not UTF-8 text"):
        read_user_file(environment)
    path.unlink()
    path.mkdir()
    with pytest.raises(InvalidFile, match="Is a directory"):
        read_user_file(environment)


@pytest.mark.parametrize("error", [PermissionError(13, "Permission denied"), OSError(40, "a loop")])
def test_a_home_that_cannot_be_read_is_named_and_has_no_settings(error, write, monkeypatch):
    environment = write("domain: 3\n")

    def refuse(*_, **__):
        raise error

    monkeypatch.setattr(Path, "stat", refuse)
    found = read_user_file(environment)
    path = user_path(environment)
    assert path is not None
    assert not found.values
    assert found.problem == f"cannot look into {path.parent}: {error.strerror}"


def test_a_change_of_the_file_is_seen(write):
    assert read_user_file(write("domain: 3\n")).values == {"domain": "3"}
    assert read_user_file(write("domain: 14\n")).values == {"domain": "14"}


def test_flag_wins_over_variable_over_file_over_default(write):
    environment = write("domain: 3\n")
    file = read_user_file(environment)
    assert lookup("domain", None, {}, NO_FILE).source == "default"
    assert lookup("domain", None, environment, file).source == f"{file.path}:1"
    environment["LCMTOOLS_DOMAIN"] = "4"
    assert lookup("domain", None, environment, file).source == "LCMTOOLS_DOMAIN"
    assert lookup("domain", "5", environment, file).source == "--domain"
    assert lookup("domain", None, environment | {"LCMTOOLS_DOMAIN": ""}, file).value == "3"


@pytest.mark.parametrize("name", SETTINGS)
def test_every_setting_has_its_rank_in_all_three_places(name):
    setting = SETTINGS[name]
    file = UserFile(Path("/f"), {name: "c"}, {name: 1})
    assert lookup(name, "a", {setting.variable: "b"}, file).value == "a"
    assert lookup(name, None, {setting.variable: "b"}, file).value == "b"
    assert lookup(name, None, {}, file).value == "c"
    assert lookup(name, None, {}, NO_FILE).value == setting.default


def test_the_namespace_of_the_file_is_usual(write):
    environment = write("namespace: /husky0\n")
    assert usual_namespace(environment) == "/husky0"
    assert usual_namespace(environment | {"LCMTOOLS_NAMESPACE": "/other"}) == "/other"


def test_the_bus_of_the_file_comes_after_all_else():
    url = "udpm://239.255.76.67:7777?ttl=0"
    both = UserFile(Path("/f"), {"lcm_url": url, "domain": "3"}, {"lcm_url": 1, "domain": 2})
    domain = UserFile(Path("/f"), {"domain": "3"}, {"domain": 2})
    assert [str(choose_url(None, None, {}, file)[0].port) for file in (both, domain)] == [
        "7777",
        "7670",
    ]
    assert choose_url(None, None, {}, domain)[1] == "/f:2"
    assert choose_url(None, "4", {}, both)[1] == "--domain"
    assert choose_url(None, None, {"LCMTOOLS_DOMAIN": "4"}, both)[1] == "LCMTOOLS_DOMAIN"
    assert choose_url(None, "5", {"LCM_DEFAULT_URL": url}, both)[1] == "--domain"


def test_a_wrong_bus_in_the_file_is_named_with_its_line():
    file = UserFile(Path("/f"), {"domain": "x"}, {"domain": 2})
    with pytest.raises(UsageError, match=r"^/f:2 'x' is not a domain"):
        choose_url(None, None, {}, file)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("2", 2.0),
        ("2s", 2.0),
        ("500ms", 0.5),
        ("1m", 60.0),
        ("1h", 3600.0),
        ("1.5s", 1.5),
        (".5", 0.5),
        ("0", 0.0),
    ],
)
def test_durations_are_read_with_their_units(text, seconds):
    assert parse_duration(text) == seconds


@pytest.mark.parametrize("text", ["", "s", "-1", "1d", "1 s", "1S", "inf", "nan", "1e3", "٣"])
def test_other_durations_are_refused(text):
    with pytest.raises(UsageError, match="is not a duration; write 500ms, 2s or 1m"):
        parse_duration(text)
