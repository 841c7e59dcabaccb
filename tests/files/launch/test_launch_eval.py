"""``$(eval ...)`` gives what Python's eval gives with roslaunch's names."""

import math

import pytest
from fixtures.says import raises_saying

from lcmtools.errors import UsageError
from lcmtools.launch.substitution import Known, substitute

ARGUMENTS = {"robot": "Husky/a200", "count": "3", "speed": "1.5", "fast": "true", "name": "nan"}
ENVIRONMENT = {"ROBOT": "dolly"}
FOLDER = "/home/me/my robot"


def typed(text):
    """Roslaunch's ``convert_value(text, "auto")``."""
    try:
        return float(text) if "." in text else int(text)
    except ValueError:
        return text == "true" if text in ("true", "false") else text


NAMES = {
    **{name: getattr(math, name) for name in dir(math) if not name.startswith("_")},
    "true": True,
    "false": False,
    "int": int,
    "round": round,
    "float": float,
    "str": str,
    "arg": lambda name: typed(ARGUMENTS[name]),
    "env": lambda name: ENVIRONMENT[name],
    "optenv": lambda name, default="": ENVIRONMENT.get(name, default),
    "dirname": lambda: FOLDER,
    "find": lambda name: f"/ros/{name}",
    **{name: typed(text) for name, text in ARGUMENTS.items()},
}


@pytest.mark.parametrize(
    "text",
    [
        "optenv('ROBOT', 'husky') == 'dolly'",
        "optenv('NOTHING', 'husky')",
        "optenv('NOTHING')",
        "env('ROBOT') + '_1'",
        "dirname() + '/worlds/' + arg('robot').lower() + '.world'",
        "find('maps') + '/a.yaml'",
        "arg('robot').split('/')[0]",
        "arg('robot').split('/')[-1].upper()",
        "arg('robot')[0:5]",
        "arg('robot').replace('/', '_')",
        "arg('robot').startswith('Husky') and not arg('robot').endswith('b')",
        "'/'.join(['a', 'b'])",
        "robot.split('/')",
        "'a200' in robot.split('/')",
        "'  x '.strip()",
        "arg('count') * 2 + 1",
        "-1.57 if arg('fast') else speed",
        "str(floor(2.7)) + str(pow(2, 3)) + str(ceil(speed))",
        "log(e) if false else exp(0)",
        "name == 'nan'",
        "int('12') + len(robot)",
        "count == 3 and speed < 2",
        "2 ** 3",
        "arg('count') ** 2 - 1",
        "2 ** -1",
        "2.0 ** 2",
        "7 // 2",
        "round(2.6)",
        "round(2.65, 1)",
    ],
)
def test_value_is_that_of_python(text):
    known = Known(ARGUMENTS, ENVIRONMENT, FOLDER, lambda name: f"/ros/{name}")
    assert substitute(f"$(eval {text})", known) == str(eval(text, NAMES))  # noqa: S307 - roslaunch's way, of the texts above


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("arg('count').split('/')", "3 is no text"),
        ("arg('robot').format(1)", "no such function in 'arg('robot').format(1)'"),
        ("arg('robot').__class__", "is not allowed"),
        ("arg('robot').split('/')[5]", "2 elements, none at 5"),
        ("dirname('x')", "wrong arguments"),
        ("optenv()", "wrong arguments"),
        ("('x' * 9).lower()", "a number is needed, not text"),
        ("'aaaaaaaaaa'.replace('a', arg('long'))", "longer than 10000 characters"),
    ],
)
def test_what_cannot_be_worked_out_is_named(text, reason):
    known = Known({**ARGUMENTS, "long": "x" * 9000}, ENVIRONMENT, FOLDER, str)
    with raises_saying(UsageError, reason):
        substitute(f"$(eval {text})", known)
