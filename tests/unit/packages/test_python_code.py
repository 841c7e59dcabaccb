"""lcm-gen's code with keyword arguments: odd names, and code that runs without lcmtools."""

import copy
import pickle
import subprocess
import sys

import pytest

from lcmtools.message_value import MessageValue
from lcmtools.packages.lcm_gen import generate_code

ODD = """\
package box;

struct Odd
{
    int32_t size;
    int32_t self;
    int32_t _self;
    double range;
    double box;
    float grid[2][3];
    box.Inner inner[size];
    box.Inner one;
    byte key[2];
    string word;
    boolean is_set;
    int64_t dim0;
}
"""
INNER = "package box;\nstruct Inner { const int32_t MOST = 3; int8_t lcmtools; int16_t _self; }\n"


@pytest.fixture
def folder(write, monkeypatch):
    """A folder with the generated code, from which Python imports."""
    root = write({"box/Odd.lcm": ODD, "box/Inner.lcm": INNER})
    generate_code([root / "box/Inner.lcm", root / "box/Odd.lcm"], "python", root / "made")
    monkeypatch.syspath_prepend(root / "made")
    yield root / "made"
    for name in [name for name in sys.modules if name.partition(".")[0] == "box"]:
        del sys.modules[name]


@pytest.mark.usefixtures("folder")
def test_fields_may_be_called_like_the_words_of_the_code():
    import box

    cls = box.Odd
    message = cls()
    assert isinstance(message, MessageValue)
    assert repr(message) == (
        "Odd(self=0, _self=0, range=0.0, box=0.0, grid=[[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],"
        " inner=[],"
        " one=Inner(lcmtools=0, _self=0), key=b'', word='', is_set=False, dim0=0)"
    )
    made = cls(self=1, range=2.0, box=3.0, dim0=4, size=1, inner=[box.Inner(5, 6)], key=b"ab")
    assert (made.self, made.range, made.box, made.dim0, made.inner[0].lcmtools) == (1, 2, 3, 4, 5)
    assert cls.decode(made.encode()) == made == copy.deepcopy(made) != message
    assert pickle.loads(pickle.dumps(made)) == made  # noqa: S301 - ours
    assert box.Inner.MOST == 3
    with pytest.raises(TypeError, match="Inner has the fields lcmtools, _self; Inner"):
        box.Inner(x=1)


def test_generated_code_also_runs_without_lcmtools(folder):
    program = f"""
import sys
sys.path.insert(0, {str(folder)!r})
import box
message = box.Odd(word="hi", one=box.Inner(lcmtools=3), key=b"ab")
print(box.Odd.decode(message.encode()).one.lcmtools, box.Odd.__base__.__name__)
print("lcmtools" in sys.modules)
"""
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", program], check=True, capture_output=True, text=True
    )
    assert done.stdout == "3 object\nFalse\n"
