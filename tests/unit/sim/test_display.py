"""The window is refused before pybullet could end the process."""

import pytest

from lcmtools.errors import LcmtoolsError
from lcmtools_sim.engines.native import check_display


@pytest.mark.parametrize("environment", [{}, {"DISPLAY": ""}])
def test_without_a_display_it_is_one_clear_line(environment: dict[str, str]) -> None:
    with pytest.raises(LcmtoolsError, match="--gui needs a display and DISPLAY is not set"):
        check_display(environment)


def test_a_display_that_is_not_there_is_named() -> None:
    with pytest.raises(LcmtoolsError, match="--gui cannot open the display ':4711'"):
        check_display({"DISPLAY": ":4711"})
