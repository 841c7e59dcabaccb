"""Arrays in the messages of arrays, as columns of tables."""

import pytest

from lcmtools import message_class
from lcmtools.messages.codec import encode
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.plain import to_plain

CONTACT = "{force: [1, 2, 3], points: [[1, 2, 3], [4, 5, 6]], raw: [1, 2], label: x}"
GRID = "grid: [[{value: 1, on: true}, {corner: [1, 2]}]], words: [[a, b]]"
EMPTY, ONE = "{}", f"{{bodies: [{{name: a, contacts: [{CONTACT}]}}], {GRID}}}"
RAGGED = f"{{bodies: [{{contacts: [{CONTACT}, {{}}]}}, {{name: b}}, {{contacts: [{{}}]}}], {GRID}}}"
ROWS = "{grid: [[{value: 1}], [{value: 2}]], words: [[a], [b]]}"
NO_ROWS = "{cols: 4}"


def part(plain, path):
    """The values of a column in a message: a list for each array on the way."""
    if isinstance(plain, list) and path:
        return [part(one, path) for one in plain]
    name, _, rest = path.partition(".")
    return part(plain[name], rest) if path else plain


@pytest.mark.parametrize(
    "texts",
    [
        [EMPTY, EMPTY],
        [ONE, ONE],
        [RAGGED, RAGGED],
        [ROWS, ROWS],
        [NO_ROWS],
        [RAGGED],
        [EMPTY, ONE, RAGGED, ROWS, NO_ROWS],
        [ROWS, RAGGED, ONE, ONE],
    ],
)
def test_parquet_has_lists_in_lists(family, cli, log_of, tmp_path, texts):
    from pyarrow import parquet

    family("nested_arrays")
    cls = message_class("nested_arrays/scene_t")
    messages = [draft_from_values(cls, [text]).message for text in texts]
    log, target = log_of("SCENE", *map(encode, messages)), tmp_path / "scene.parquet"
    counted = "1 message" if len(texts) == 1 else f"{len(texts)} messages"
    assert cli("bag", "export", log, str(target)).ok() == f"{target}: {counted}\n"
    found = parquet.read_table(target).to_pydict()
    assert found.pop("%time")
    expected = {name: [part(to_plain(one), name) for one in messages] for name in found}
    assert found == expected
    assert "bodies.contacts.points" in found
