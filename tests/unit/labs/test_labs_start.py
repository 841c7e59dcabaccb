"""lab start and lab check name all that is missing at once, before anything else."""

import pytest
from fixtures.says import assert_says

from lcmtools.errors import MissingExtra
from lcmtools.labs.commands import lab


@pytest.mark.parametrize(
    ("missing", "extras", "hint"),
    [
        ({"numpy", "pybullet", "mujoco", "websockets"}, "extras 'sim' and 'web'", "[sim,web]'"),
        ({"pybullet", "mujoco"}, "extra 'sim'", "[sim]'"),
        ({"websockets"}, "extra 'web'", "[web]'; --no-view starts the simulator alone"),
    ],
)
def test_all_missing_extras_are_named_together(missing, extras, hint, monkeypatch):
    monkeypatch.setattr(lab, "find_spec", lambda name: None if name in missing else name)
    with pytest.raises(MissingExtra) as error:
        lab.require_extras("lab start", ["sim", "web"])
    assert_says(str(error.value), f"lab start needs the {extras}", hint)


def test_one_engine_is_enough(monkeypatch):
    monkeypatch.setattr(lab, "find_spec", lambda name: None if name == "pybullet" else name)
    lab.require_extras("lab start", ["sim", "web"])


def test_a_check_without_an_engine_says_so_before_it_says_what_it_simulates(cli, monkeypatch):
    missing = {"pybullet", "mujoco"}
    monkeypatch.setattr(lab, "find_spec", lambda name: None if name in missing else name)
    done = cli("lab", "check", "husky")
    assert (done.code, done.out, done.err.count("\n")) == (3, "", 1)
    assert_says(done.err, "lcmtools lab check: lab check needs the extra 'sim'", "[sim]'")
