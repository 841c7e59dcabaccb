"""Launch files of a few lines that would grow without end."""

import pytest
from fixtures.limits import cpu_limit
from fixtures.says import raises_saying

from lcmtools.errors import InvalidFile, UsageError
from lcmtools.launch import reading
from lcmtools.launch.file import read_file
from lcmtools.launch.reading import make_plan
from lcmtools.launch.substitution import Known, substitute

DOUBLED = (f'<arg name="a{n + 1}" default="$(arg a{n})$(arg a{n})"/>' for n in range(60))


def test_arguments_that_double_are_refused(xml):
    tags = '<arg name="a0" default="ten chars."/>\n' + "\n".join(DOUBLED)
    with cpu_limit(), raises_saying(InvalidFile, "a.launch:12: the values in", "10000 characters"):
        xml(tags)


@pytest.mark.parametrize("inside", ["$(arg x)", "$(", "("])
def test_a_long_text_is_read_once(inside):
    known = Known({"x": ""}, {}, "/", str)
    text = inside * (200_000 // len(inside))
    with cpu_limit():
        if text.endswith("$("):
            with raises_saying(UsageError, "is not closed"):
                substitute(text, known)
        else:
            assert substitute(text, known) == text.replace("$(arg x)", "")


def test_includes_that_double_are_refused(folder, monkeypatch):
    monkeypatch.setattr(reading, "_MOST_INCLUDES", 100)
    for n in range(40):
        tag = f'<include file="{n + 1}.launch"/>'
        (folder / f"{n}.launch").write_text(f"<launch>\n{tag}{tag}\n</launch>")
    (folder / "40.launch").write_text("<launch/>")
    with cpu_limit(), raises_saying(InvalidFile, "more than 100 files are included"):
        make_plan([read_file(folder / "0.launch")], {}, "/", {})
