"""lab start names all that is missing at once, before anything else."""

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
def test_all_missing_extras_are_named_together(
    missing: set[str], extras: str, hint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lab, "find_spec", lambda name: None if name in missing else name)
    with pytest.raises(MissingExtra) as error:
        lab._require_extras(["sim", "web"])
    assert_says(str(error.value), f"lab start needs the {extras}", hint)


def test_one_engine_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lab, "find_spec", lambda name: None if name == "pybullet" else name)
    lab._require_extras(["sim", "web"])
