"""Substitutions in ``$( )``, and the expressions of ``$(eval ...)``."""

import pytest

from lcmtools.errors import UsageError
from lcmtools.launch.substitution import Known, substitute

KNOWN = Known(
    arguments={"robot": "husky0", "n": "2", "flag": "true", "text": "$(arg n)"},
    environment={"HOME": "/home/me"},
    folder="/labs",
    package_folder=lambda name: f"/packages/{name}",
)


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("plain $ text (a)", "plain $ text (a)"),
        ("/$(arg robot)/x", "/husky0/x"),
        ("$(var robot)", "husky0"),
        ("$(arg text)", "$(arg n)"),
        ("$(env HOME)$(env HOME)", "/home/me/home/me"),
        ("$(optenv HOME x)", "/home/me"),
        ("$(optenv NOPE a b)", "a b"),
        ("$(optenv NOPE)", ""),
        ("$(find air_lab0)/launch", "/packages/air_lab0/launch"),
        ("$(dirname)/a", "/labs/a"),
        ("$(eval n * (3 + 1))", "8"),
        ("$(eval arg('n') + 1)", "3"),
        ("$(eval 'a)' + robot)", "a)husky0"),
        ("$(eval 'x' if flag and not n > 5 else 'y')", "x"),
        ("$(eval env('HOME') + '/a')", "/home/me/a"),
        ("$(eval robot in ['husky0', 'husky1'] or false)", "True"),
        ("$(eval str(int(2.9)) + 'm')", "2m"),
        ("$(eval round(sqrt(2), 3))", "1.414"),
        ("$(eval 1 / 4)", "0.25"),
    ],
)
def test_what_is_put_in(text, result):
    assert substitute(text, KNOWN) == result


def test_anonymous_name_is_the_same_in_one_launch_and_differs_between_names():
    first, again, other = (substitute(f"$(anon {name})", KNOWN) for name in ("a", "a", "b"))
    assert first == again
    assert first.startswith("a_")
    assert first != other.replace("b_", "a_")


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("$(arg robto)", "there is no argument 'robto'; did you mean robot?"),
        ("$(arg)", "'$(arg )' needs one name"),
        ("$(arg a b)", "'$(arg a b)' needs one name"),
        ("$(env A b)", "'$(env A b)' needs one name; write $(optenv A b)"),
        ("$(env NOPE)", "the environment variable NOPE is not set; or write $(optenv NOPE DEF"),
        ("$(arg robot", "'$(' is not closed in '$(arg robot'"),
        ("$(ag robot)", "there is no '$(ag ...)'; did you mean arg?"),
        ("$(eval )", "eval: the expression is empty; write for example"),
        ("$(eval n +)", "eval: cannot read 'n +'"),
        ("$(eval nope)", "there is no 'nope'"),
        ("$(eval __import__('os'))", "no such function in '__import__('os')'"),
        ("$(eval robot.format())", "no such function in 'robot.format()'"),
        ("$(eval robot.x)", "'robot.x' is not allowed"),
        ("$(eval [x for x in robot])", "is not allowed"),
        ("$(eval (lambda: 1)())", "no such function"),
        ("$(eval 9 ** 9 ** 9)", "cannot work out"),
        ("$(eval 'a' * 1000000000)", "a number is needed, not text"),
        ("$(eval 1 / 0)", "cannot work out '1 / 0': division by zero"),
        ("$(eval n is 2)", "write == or !="),
        (f"$(eval {'(' * 500}1{')' * 500})", "the expression is longer than 1000"),
        (f"$(eval {'-' * 100}1)", "nested more than 40 levels deep"),
    ],
)
def test_what_cannot_be_put_in_is_told(text, reason):
    with pytest.raises(UsageError) as caught:
        substitute(text, KNOWN)
    assert reason in str(caught.value)
