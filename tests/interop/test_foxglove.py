"""MCAP files of ours, decoded by Foxglove's own packages (npm), field for field."""

import json
import math
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from lcmtools.bag.ros_bags import Encoding, McapFile
from lcmtools.messages.codec import encode
from lcmtools.messages.fields import Field, visible_fields
from lcmtools.messages.plain import to_plain
from lcmtools.messages.registry import Message, message_class, type_names
from lcmtools.observe.decoding import Decoder
from lcmtools.wire.packet import Packet

_SCRIPTS = Path(__file__).parent / "foxglove"
_TIME = 1_700_000_000_123_456_789


@pytest.fixture(scope="module")
def decode(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The script that decodes, beside the packages that it needs."""
    if not (shutil.which("node") and shutil.which("npm")):
        pytest.skip("node and npm are not installed")
    folder = tmp_path_factory.mktemp("foxglove")
    for file in _SCRIPTS.iterdir():
        shutil.copy(file, folder)
    install = ["npm", "ci", "--silent", "--no-audit", "--prefer-offline", "--fetch-retries=0"]
    if subprocess.run(install, cwd=folder, check=False).returncode:
        pytest.skip("npm cannot install Foxglove's packages")
    return folder / "decode.mjs"


def _filled(name: str, count: int = 0) -> Message:
    """A message of a type with another value in every field."""
    message = message_class(name)()
    for number, part in enumerate(visible_fields(type(message)), count + 1):
        setattr(message, part.name, _values(part, list(part.dimensions), number))
    return message


def _values(part: Field, sizes: list[int | str], number: int) -> object:
    if sizes:
        size = sizes[0] if isinstance(sizes[0], int) else 2
        return [_values(part, sizes[1:], number + place) for place in range(size)]
    if part.message_class:
        return _filled(part.type, number)
    if part.type == "string":
        return f"text {number} ä"
    if part.type == "bool":
        return bool(number % 2)
    return number + 0.25 if part.type.startswith("float") else number


def _as_foxglove_has_it(plain: object, encoding: Encoding) -> object:
    if isinstance(plain, Mapping):
        names = {
            name.lower() if encoding == "cdr" else name: value
            for name, value in plain.items()
            if not (encoding == "cdr" and name == "seq")
        }
        return {name: _as_foxglove_has_it(value, encoding) for name, value in names.items()}
    return (
        [_as_foxglove_has_it(one, encoding) for one in plain] if isinstance(plain, list) else plain
    )


def _same(found: object, wanted: object) -> bool:
    """Return whether values are equal, but for the names of nanoseconds."""
    if isinstance(wanted, Mapping) and isinstance(found, Mapping):
        found = {"nsec" if name == "nanosec" else name: one for name, one in found.items()}
        wanted = {"nsec" if name == "nanosec" else name: one for name, one in wanted.items()}
        return found.keys() == wanted.keys() and all(
            _same(found[name], one) for name, one in wanted.items()
        )
    if isinstance(wanted, list) and isinstance(found, list):
        return len(found) == len(wanted) and all(map(_same, found, wanted))
    if isinstance(found, str) and isinstance(wanted, int):  # 64 bits
        return int(found) == wanted
    return math.isclose(found, wanted) if isinstance(wanted, float) else found == wanted  # type: ignore[arg-type]


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_every_type_is_decoded_field_for_field(
    encoding: Encoding, decode: Path, tmp_path: Path
) -> None:
    messages = {name: _filled(name) for name in type_names()}
    path = tmp_path / "a.mcap"
    with McapFile(path, encoding) as file:
        for place, (name, message) in enumerate(messages.items()):
            packet = Packet(f"/{name}", encode(message), _TIME + place)
            file.add(packet, Decoder(lambda _, name=name: (name,)))  # type: ignore[misc]
    run = subprocess.run(["node", decode, path], capture_output=True, text=True, check=True)  # noqa: S607
    rows = [json.loads(line) for line in run.stdout.splitlines()]
    assert [row["topic"] for row in rows] == [f"/{name}" for name in messages]
    assert [int(row["time"]) for row in rows] == [_TIME + place for place in range(len(rows))]
    for row, message in zip(rows, messages.values(), strict=True):
        wanted = _as_foxglove_has_it(to_plain(message), encoding)
        assert _same(row["message"], wanted), (row, wanted)
