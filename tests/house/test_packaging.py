"""The built project as a user gets it: everything needed, from the sdist as from the checkout.

The sdist is built from the checkout and the wheel from the unpacked sdist, as a distributor would.
"""

import configparser
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest
from man_pages import commands, page

ROOT = Path(__file__).resolve().parents[2]


def run_python(*arguments, cwd):
    """Run Python and return its output; what it says on stderr is shown if it fails."""
    command = [sys.executable, *arguments]
    finished = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    return finished.stdout


def build(kind, project, folder):
    """Build the sdist or wheel of a project into a folder of its own."""
    run_python("-m", "hatchling", "build", "-t", kind, "-d", str(folder), cwd=project)
    (built,) = folder.iterdir()
    return built


@pytest.fixture(scope="module")
def sdist(tmp_path_factory):
    """The unpacked sdist."""
    folder = tmp_path_factory.mktemp("sdist")
    with tarfile.open(build("sdist", ROOT, folder / "dist")) as archive:
        # Python knows filters from 3.11.4 and 3.10.12 on
        archive.extraction_filter = getattr(tarfile, "data_filter", None)
        archive.extractall(folder)  # noqa: S202 - our own
    (unpacked,) = folder.glob("lcmtools_robotics-*")
    return unpacked


@pytest.fixture(scope="module")
def wheel(sdist, tmp_path_factory):
    """The wheel built from the sdist."""
    return zipfile.ZipFile(build("wheel", sdist, tmp_path_factory.mktemp("wheel") / "dist"))


def files_of(folder):
    """Return the files that a package consists of, relative to the folder above it."""
    return {
        path.relative_to(folder.parent).as_posix()
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


@pytest.mark.parametrize("package", ["lcmtools", "sim/lcmtools_sim"])
def test_wheel_holds_every_file_of_the_package(wheel, package):
    assert files_of(ROOT / package) - set(wheel.namelist()) == set()


def test_wheel_holds_types_stubs_and_markers(wheel):
    expected = {
        "lcmtools/py.typed",
        "lcmtools/types/fingerprints.py",
        "lcmtools/types/nav_msgs/Odometry.py",
        "lcmtools/types/nav_msgs/Odometry.pyi",
        "lcmtools/types/std_srvs/Trigger.py",
        "lcmtools_sim/py.typed",
    }
    assert expected - set(wheel.namelist()) == set()


def test_wheel_holds_the_lcm_file_of_every_type(wheel):
    sources = {str(path.relative_to(ROOT / "lcm_types")) for path in ROOT.glob("lcm_types/*/*.lcm")}
    folder = "lcmtools/lcm_files/"
    shipped = {name for name in wheel.namelist() if name.startswith(folder)}
    assert {name.removeprefix(folder) for name in shipped} == sources, "see force-include"


def test_wheel_holds_nothing_but_the_two_packages(wheel):
    tops = {name.partition("/")[0] for name in wheel.namelist()}
    metadata = {top for top in tops if top.endswith((".dist-info", ".data"))}
    assert tops - metadata == {"lcmtools", "lcmtools_sim"}


def test_wheel_holds_the_man_pages_where_man_finds_them(wheel):
    pages = {f"{'-'.join(words)}.1": page(words) for words in commands()}
    folder = "/data/share/man/man1/"
    shipped = {name.partition(folder)[2]: name for name in wheel.namelist() if folder in name}
    assert set(shipped) == set(pages)
    name = "lcmtools-echo.1"
    assert wheel.read(shipped[name]).decode() == pages[name]


def test_every_entry_point_is_in_the_wheel(wheel):
    (name,) = (name for name in wheel.namelist() if name.endswith("/entry_points.txt"))
    points = configparser.ConfigParser(delimiters=("=",))
    points.read_string(wheel.read(name).decode())
    targets = {
        target.partition(":")[0] for part in points.sections() for target in points[part].values()
    }
    modules = {f"{target.replace('.', '/')}.py" for target in targets}
    assert "lcmtools/__main__.py" in modules
    assert modules - set(wheel.namelist()) == set()


@pytest.mark.parametrize("folder", ["lcm_types", "labs", "tests"])
def test_sdist_holds_every_file_of_the_folder(sdist, folder):
    assert files_of(ROOT / folder) - files_of(sdist / folder) == set()


def test_sdist_holds_pages_and_project_file(sdist):
    expected = {"LICENSE", "README.md", "hatch_build.py", "pyproject.toml"}
    assert expected - {path.name for path in sdist.iterdir()} == set()


def test_types_can_be_made_from_the_sdist(sdist):
    run_python("lcm_types/generate.py", "--check", cwd=sdist)


def test_installed_wheel_offers_the_types(wheel, tmp_path):
    target = tmp_path / "site"
    pip = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--no-compile"]
    run_python(*pip, "--target", str(target), str(wheel.filename), cwd=tmp_path)
    program = f"""
import sys
sys.path.insert(0, {str(target)!r})
from lcmtools.types.nav_msgs import Odometry
print(sys.modules["lcmtools"].__file__)
print(Odometry.decode(Odometry().encode()).twist.twist.linear.x)
"""
    # -I -S: neither this project's folder nor an editable install may answer.
    printed = run_python("-I", "-S", "-c", program, cwd=tmp_path)
    assert printed.splitlines() == [str(target / "lcmtools" / "__init__.py"), "0.0"]
