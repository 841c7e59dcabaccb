"""The simulator's command line."""

import pytest

from lcmtools.errors import UsageError
from lcmtools_sim.__main__ import main
from lcmtools_sim.options import parse_options


def test_without_arguments_it_is_the_husky_world_in_real_time() -> None:
    options = parse_options([])

    assert (options.world, options.rate, options.seed) == ("husky", 1.0, None)


@pytest.mark.parametrize("arguments", [["empty"], ["--world", "empty"], ["--world=empty", "empty"]])
def test_a_world_is_given_as_a_word_or_as_an_option(arguments: list[str]) -> None:
    assert parse_options(arguments).world == "empty"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--rate", "fast"], "argument --rate: must be times real time, 0 or more, not 'fast'"),
        (["--rate", "-1"], "argument --rate: must be times real time, 0 or more, not '-1'"),
        (["--rate", "nan"], "argument --rate: must be times real time, 0 or more, not 'nan'"),
        (["--rate", "inf"], "argument --rate: must be times real time, 0 or more, not 'inf'"),
        (["--seed", "1.5"], "argument --seed: must be a whole number, 0 or more, not '1.5'"),
        (["--duration", "0"], "argument --duration: must be a number of seconds above 0, not '0'"),
        (["--wrold", "x"], "unrecognized arguments: --wrold"),
        (["--world"], "argument --world: expected one argument"),
        (["a", "--world", "b"], "two worlds are given, 'a' and 'b'"),
    ],
)
def test_a_mistake_is_one_clear_line(arguments: list[str], reason: str) -> None:
    with pytest.raises(UsageError) as caught:
        parse_options(arguments)

    assert caught.value.what.startswith(reason)


def test_worlds_are_listed_with_what_they_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--list-worlds"]) == 0

    assert capsys.readouterr().out == (
        "empty  The ground and nothing on it\n"
        "husky  A walled yard with one Husky: the world of the TDDE05 lab\n"
    )


def test_a_printed_world_can_be_checked(
    capsys: pytest.CaptureFixture[str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    assert main(["--print-world", "husky"]) == 0
    file = tmp_path_factory.mktemp("worlds") / "mine.yaml"
    file.write_text(capsys.readouterr().out)

    assert main(["--check", str(file)]) == 0

    assert capsys.readouterr().out == f"{file}: ok, husky /husky0; 11 things\n"


def test_a_bad_world_is_one_line_and_exit_code_2(
    capsys: pytest.CaptureFixture[str], tmp_path_factory: pytest.TempPathFactory
) -> None:
    file = tmp_path_factory.mktemp("worlds") / "bad.yaml"
    file.write_text("node: a\nrobots: 3\n")

    assert main(["--world", str(file)]) == 2

    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == (
        f"lcmtools run sim: {file}:2: 'robots' must be a list, not a single value\n"
    )


def test_help_shows_examples(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["--help"])

    assert caught.value.code == 0
    assert "lcmtools run sim --world ./yard.yaml --rate 4" in capsys.readouterr().out
