"""Text of files with sequences that control a terminal: printed escaped, wherever it comes from."""

import re

import pytest

from lcmtools.bag.writer import LogWriter
from lcmtools.messages.codec import encode
from lcmtools.types.geometry_msgs import Vector3
from lcmtools.wire.packet import Packet

EVIL = "\x1b]0;evil\x07\x1b[31m\x9b31m"
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")

FILES = {
    "own/msg/N.msg": f'string A="{EVIL}\0"\nint8 x # {EVIL}\n',
    "own/msg/Broken.msg": f"int8 {EVIL}\n",
    "text.launch": "<launch><arg name='\x9b31m'/></launch>",
    "tag.launch": "<launch><node pkg='\x9b31m' type='a' name='b'/></launch>",
    "a.yaml": "nodes:\n  - run: \x9b31m\n",
    "world.yaml": 'scene: {"\x9b31m": 1}\n',
    "world.sdf": "<sdf version='1.6'><world name='\x9b31m'><\x9b31m/></world></sdf>",
    "contract.yaml": 'topics: {"/a": {"\x9b31m": 1}}\n',
    "evidence.json": '{"lcmtools_evidence": 1, "evidence": {"\x9b": 1}}',
}
COMMANDS = [
    "msg show own/N",
    "msg show -r own/N",
    "msg show own/Broken",
    "msg list",
    "msg build .",
    "launch text.launch",
    "launch tag.launch",
    "launch a.yaml",
    "run sim world.yaml",
    "run sim --check world.sdf",
    "bag check a.lcmlog --against contract.yaml",
    "wtf --from evidence.json",
    "wtf -b a.lcmlog",
    "bag info a.lcmlog",
    "list -b a.lcmlog -v",
    "echo -b a.lcmlog --all",
    "bag plot a.lcmlog **/x",
    "graph -b a.lcmlog",
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with such files, the current one."""
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    with LogWriter(tmp_path / "a.lcmlog") as log:
        for count in range(3):
            log.add(Packet(f"/{EVIL}", encode(Vector3(x=float(count))), count * 10**9))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LCMTOOLS_TYPE_PATH", str(tmp_path))
    return tmp_path


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("words", COMMANDS)
def test_nothing_controls_the_terminal(words, cli):
    result = cli(*words.split())
    assert result.out or result.err
    assert not CONTROL.search(result.out + result.err), result
    assert "a fault of lcmtools" not in result.err, result
