"""The numbers behind the labs' checks: step responses, circles, keys, likeness, ranges."""

import math
import shutil
from random import Random

import pytest

from lcmtools.errors import UsageError
from lcmtools.labs.catalogue import LABS, find_lab
from lcmtools.labs.checks.check import CHECKS
from lcmtools.labs.checks.choice import choose
from lcmtools.labs.checks.dolly import ranges_in
from lcmtools.labs.checks.measures import GOOD, analyse, explained, fit_radius
from lcmtools.labs.checks.teleop import DRIVING_KEYS, SPEED_KEYS, is_alike
from lcmtools.labs.checks.viewer import viewer_command
from lcmtools.packages.create import NewPackage, create


def first_order(target, time_constant):
    times = [step / 50 for step in range(400)]
    return [(time, target * (1 - math.exp(-time / time_constant))) for time in times]


@pytest.mark.parametrize("target", [0.5, -0.3])
def test_a_first_order_response_settles_after_three_time_constants(target):
    response = analyse(first_order(target, 0.5), target)
    assert response.reached == pytest.approx(target, rel=1e-4)
    assert response.settled_after == pytest.approx(0.5 * math.log(20), abs=0.02)
    assert response.overshoot == pytest.approx(0.0)


def test_a_response_that_leaves_the_band_at_the_end_has_not_settled():
    samples = [*first_order(1.0, 0.1), (8.0, 1.2)]
    response = analyse(samples, 1.0)
    assert response.settled_after is None
    assert response.overshoot == pytest.approx(0.2)


def test_the_radius_of_a_piece_of_a_noisy_circle_is_found():
    noise = Random(1)  # noqa: S311 - the same each time
    angles = [noise.uniform(0, 4) for _ in range(300)]
    points = [
        (3 + 1.667 * math.cos(a) + noise.gauss(0, 0.003), -2 + 1.667 * math.sin(a)) for a in angles
    ]
    assert fit_radius(points) == pytest.approx(1.667, abs=0.003)


@pytest.mark.parametrize("points", [[], [(1.0, 1.0)] * 5, [(float(x), 2.0 * x) for x in range(9)]])
def test_points_on_no_circle_have_no_radius(points):
    assert fit_radius(points) is None


def test_keys_have_the_meanings_of_the_model_answer_and_a_fixed_order():
    assert [*DRIVING_KEYS] == [*"i,jluom.k"]
    assert (DRIVING_KEYS["m"], DRIVING_KEYS["."]) == (
        "backward, clockwise",
        "backward, counter-clockwise",
    )
    assert [*SPEED_KEYS] == [*"qzwxec"]
    assert (SPEED_KEYS["z"], SPEED_KEYS["e"]) == ("both 10 % less", "turning 10 % more")


def test_a_rounded_command_is_like_and_a_wrong_one_is_not():
    assert is_alike((0.605, 1.21), (0.6, 1.21))
    assert not is_alike((0.55, 1.0), (0.5, 1.0))
    assert not is_alike(None, (0.0, 0.0))


def picture_of(depth):
    """A colour map whose brightness is not monotonous."""
    return 128 + 100 * math.sin(depth / 300), depth / 20, 255 - depth / 20


def test_any_colour_map_shows_the_depth_and_a_shuffled_picture_does_not():
    noise = Random(2)  # noqa: S311 - the same each time
    depths = [500 + 40 * (pixel % 100) + noise.randrange(20) for pixel in range(5000)]
    colors = [picture_of(depth) for depth in depths]
    assert explained(depths, colors) > GOOD
    assert explained(depths, [(255 - depth / 20,) for depth in depths]) > GOOD
    assert explained(depths, noise.sample(colors, len(colors))) < GOOD
    assert explained(depths, [(0.0,)] * len(depths)) == 0.0


def test_ranges_are_found_among_other_numbers():
    ranges = [math.inf, 3.2512, 7.049, math.nan]
    line = "[INFO] [1795267339.406] [/reading]: 200 ranges: right nothing, ahead 3.25 m, 45 degrees"
    assert ranges_in(line, ranges) == ["3.25"]
    assert ranges_in("nothing but inf and 9.99", ranges) == []


def test_a_viewer_gets_the_files_name_where_it_wants_it():
    assert viewer_command(["v", "-o={picture}"], "a.png") == ["v", "-o=a.png"]
    assert viewer_command(["v"], "a.png") == ["v", "--save", "a.png"]


def test_every_program_has_a_check_and_belongs_to_one_lab():
    programs = [program.option for lab in LABS.values() for program in lab.programs]
    assert sorted(programs) == sorted(CHECKS)
    assert all(find_lab(name) is lab for name, lab in LABS.items())


def test_names_are_added_unless_the_command_line_has_its_own():
    (run,), _ = choose(LABS["husky"], {"controller": "python3 'my node.py'"})
    names = ["__ns:=/husky0", "controlled_velocity:=velocity_cmd"]
    assert run.command == ["python3", "my node.py", *names]
    (run,), _ = choose(LABS["husky"], {"controller": "sh node __ns:=/husky0"})
    assert run.command == ["sh", "node", "__ns:=/husky0"]
    assert not run.is_answer
    assert all(run.is_answer for run in choose(LABS["husky"], {})[0])
    with pytest.raises(UsageError, match="not a program of the lab dolly"):
        choose(LABS["dolly"], {"viewer": "x"})


def test_a_program_that_cannot_be_started_is_refused_before_anything_is_simulated(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "node").touch()
    for words, reason in {"./none": "No such file", "none x": "No such", "./node": "Perm"}.items():
        with pytest.raises(UsageError, match=f"cannot run '{words.split()[0]}': {reason}"):
            choose(LABS["husky"], {"controller": words})


def test_nodes_of_the_workspace_are_checked_in_place_of_the_model_answers(tmp_path, monkeypatch):
    create(NewPackage("mine", "simple_controller"), tmp_path / "mine")
    monkeypatch.chdir(tmp_path)
    (run,), _ = choose(LABS["husky"], {})
    assert run.command[:4] == ["lcmtools", "run", "mine", "simple_controller"]
    assert not run.is_answer
    typed = {"controller": "lcmtools run simple_controller"}
    assert not choose(LABS["husky"], typed)[0][0].is_answer
    assert all(run.is_answer for run in choose(LABS["dolly"], {})[0])
    shutil.copy(tmp_path / "mine/mine/simple_controller.py", tmp_path / "mine/mine/moving_robot.py")
    with pytest.raises(UsageError, match=r"mine/mine/moving_robot\.py is not a node yet"):
        choose(LABS["dolly"], {})


def test_scripts_and_nodes_in_cpp_of_the_workspace_are_checked(tmp_path, monkeypatch):
    create(NewPackage("mine", "first"), tmp_path / "mine")
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "mine" / "src" / "evaluate_controller.py"
    script.touch()
    with pytest.raises(UsageError, match=r"mine/src/evaluate_controller.py is not executable"):
        choose(LABS["husky"], {})
    script.chmod(0o755)
    (run,), _ = choose(LABS["husky"], {})
    assert run.command[:4] == ["lcmtools", "run", "mine", "evaluate_controller.py"]
    assert choose(LABS["husky"], {"evaluator": "lcmtools run evaluate_controller"})[0][0].is_answer
    (tmp_path / "mine" / "CMakeLists.txt").write_text("add_executable(moving_robot a.cpp)")
    with pytest.raises(UsageError, match="is not built; type: lcmtools pkg build mine"):
        choose(LABS["dolly"], {})
    (tmp_path / "mine" / "build").mkdir()
    (tmp_path / "mine" / "build" / "moving_robot").touch(0o755)
    (run,), _ = choose(LABS["dolly"], {})
    assert run.command[:4] == ["lcmtools", "run", "mine", "moving_robot"]
