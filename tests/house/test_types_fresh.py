"""The committed lcmtools/types is what lcm_types/generate.py writes, and --check notices if not."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def generate(root, *arguments):
    command = [sys.executable, str(root / "lcm_types" / "generate.py"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(tmp_path):
    """A project of one's own, with nothing but the sources and the generated types."""
    ignore = shutil.ignore_patterns("__pycache__")
    for folder in ("lcm_types", "lcmtools/types"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=ignore)
    return tmp_path


def test_committed_types_are_fresh():
    checked = generate(ROOT, "--check")
    assert (checked.returncode, checked.stdout, checked.stderr) == (0, "", "")


def test_changed_comment_is_reported_without_being_written(copy):
    source = copy / "lcm_types" / "std_msgs" / "String.lcm"
    source.write_text(source.read_text().replace("the text, in UTF-8", "what is said"))
    before = (copy / "lcmtools/types/std_msgs/String.py").read_text()
    checked = generate(copy, "--check")
    assert checked.returncode == 1
    assert checked.stdout == "stale: lcmtools/types/std_msgs/String.py\n"
    assert checked.stderr == "run: python lcm_types/generate.py\n"
    assert (copy / "lcmtools/types/std_msgs/String.py").read_text() == before


def test_changed_field_is_reported_with_its_stub_and_all_fingerprints(copy):
    source = copy / "lcm_types" / "std_msgs" / "String.lcm"
    source.write_text(source.read_text().replace("string data;", "double data;"))
    stale = "".join(
        f"stale: lcmtools/types/{name}\n"
        for name in ("fingerprints.py", "std_msgs/String.py", "std_msgs/String.pyi")
    )
    assert generate(copy, "--check").stdout == stale


def test_stray_missing_and_edited_files_are_reported_and_mended(copy):
    types = copy / "lcmtools" / "types"
    (types / "std_msgs" / "Rumour.py").write_text("")
    (types / "std_msgs" / "Bool.pyi").unlink()
    (types / "__init__.py").write_text("import lcmtools.types.std_msgs\n")
    checked = generate(copy, "--check")
    assert checked.returncode == 1
    assert checked.stdout.splitlines() == [
        "stale: lcmtools/types/__init__.py",
        "stale: lcmtools/types/std_msgs/Bool.pyi",
        "stale: lcmtools/types/std_msgs/Rumour.py",
    ]
    assert generate(copy).stdout.startswith("3 of ")
    assert generate(copy, "--check").returncode == 0
    assert not (types / "std_msgs" / "Rumour.py").exists()


def test_new_service_gets_its_pair(copy):
    for suffix in ("Request", "Response"):
        source = copy / "lcm_types" / "lab_srvs" / f"Reset_{suffix}.lcm"
        source.parent.mkdir(exist_ok=True)
        source.write_text(f"package lab_srvs;\n\nstruct Reset_{suffix}\n{{\n}}\n")
    assert generate(copy).returncode == 0
    types = copy / "lcmtools" / "types" / "lab_srvs"
    exports = (types / "__init__.py").read_text()
    assert "    from .Reset import Reset as Reset\n" in exports
    assert "Request: TypeAlias = Reset_Request" in (types / "Reset.py").read_text()


def test_syntax_error_is_shown_as_lcm_gen_says_it_and_nothing_is_written(copy):
    (copy / "lcm_types" / "std_msgs" / "String.lcm").write_text("struct String{ string data; }\n")
    before = (copy / "lcmtools/types/std_msgs/String.py").read_bytes()
    generated = generate(copy)
    assert generated.returncode == 1
    assert "std_msgs/String.lcm : 1" in generated.stdout
    assert (copy / "lcmtools/types/std_msgs/String.py").read_bytes() == before


def test_unknown_type_of_a_field_is_an_error(copy):
    source = copy / "lcm_types" / "std_msgs" / "String.lcm"
    source.write_text(source.read_text().replace("string data;", "uint8_t data;"))
    checked = generate(copy, "--check")
    assert checked.returncode != 0
    assert "uint8_t" in checked.stderr
