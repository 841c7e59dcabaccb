"""Output of echo is input of pub -f: to the bit, for every type, with the values that go wrong."""

import math
import re
from itertools import count

import pytest

from lcmtools.messages.codec import decode, encode
from lcmtools.messages.fields import fields, visible_fields
from lcmtools.messages.message_template import draft_from_values, drafts_from_lines
from lcmtools.messages.path import Path, select
from lcmtools.messages.plain import plain_value, to_json
from lcmtools.messages.registry import message_class, type_names
from lcmtools.messages.scalars import INTEGERS
from lcmtools.messages.text import FREE, format_message

_DEEPEST = 3
_FLOATS = [math.nan, math.inf, -math.inf, -0.0, 1e-7, 0.1, 1e16, -1.0]
AWKWARD = {
    "bool": [True, False],
    "float32": [*_FLOATS, 1e-45, 1.1754942e-38, 3.4028234663852886e38],
    "float64": [*_FLOATS, 5e-324, 2.225073858507201e-308, 1.7976931348623157e308, 2.0**53 + 2],
    "string": [
        *("on", "no", "~", "null", "007", "0x1F", "1e3", "1_000", "1:30", ".inf", "=", "<<", ""),
        *(" ", " a ", "a: b", "a #b", "# b", "- a", "---", "...", "--- \n...\n", "? a", "! a"),
        *("'", '"', "\\", "\\n", "{a: 1}", "[1]", "&a", "*a", "%a", "@a", "`a", "|", ">"),
        *("a\nb", "\n", "a\r\nb\r", "\t", "\0", "\x07\x1b[2J", "\x7f\x85\xa0", "\u2028\u2029"),
        *("é", "\ufeff", "\ufffe\uffff", "\ufffd", "😀", "\u202e", "a" * 300, "a b " * 60),
        *("now", "auto", "2001-01-01", "yes\n---\ndata: no"),
        *("D\udcfcsseldorf", "\udcff", "\udc80 # \n---\n'\"é", "\udced\udca0\udc80"),  # no UTF-8
    ],
    **{
        name: [low, high, 0, 1, low + 1, high - 1, high // 2]
        for name, (low, high) in INTEGERS.items()
    },
}


def awkward_message(cls, numbers, depth=0):
    """A message of awkward values, a different one in each field."""
    message = cls()
    lengths = {field.name: next(numbers) % 3 for field in fields(cls) if field.is_length}
    for field in visible_fields(cls):
        sizes = [size if isinstance(size, int) else lengths[size] for size in field.dimensions]
        if depth == _DEEPEST and field.message_class:
            sizes = [0 for _ in sizes]
        setattr(message, field.name, _value(field, sizes, numbers, depth))
    return message


def _value(field, sizes, numbers, depth):
    if sizes and field.is_bytes and len(sizes) == 1:
        return bytes(next(numbers) * 85 % 256 for _ in range(sizes[0]))
    if sizes:
        return [_value(field, sizes[1:], numbers, depth) for _ in range(sizes[0])]
    if field.message_class:
        return awkward_message(field.message_class, numbers, depth + 1)
    values = AWKWARD[field.type]
    return values[next(numbers) % len(values)]


def test_all_that_echo_prints_is_taken_back_to_the_bit(subtests):
    for name in type_names():
        with subtests.test(name):
            check_taken_back(message_class(name))


def check_taken_back(cls):
    for start in range(0, 77, 7):
        payload = encode(awkward_message(cls, count(start)))
        message = decode(cls, payload, keep_stray=True)
        found = select(message, Path())
        plain = plain_value(found.value, found.target)
        written = (format_message(message), FREE.block(plain), FREE.flow(plain), to_json(message))
        for text in written:
            assert encode(draft_from_values(cls, [text]).message) == payload, text
            assert not re.search("[\0-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]", text)


@pytest.mark.parametrize("text", AWKWARD["string"])
def test_texts_survive_in_a_file_of_several_messages_and_topics(text):
    cls = message_class("diagnostic_msgs/DiagnosticStatus")
    message = cls()
    message.name, message.values = text, [message_class("diagnostic_msgs/KeyValue")()]
    message.values[0].key = text
    document = "".join(f"# /topic{n}\n{format_message(message)}\n---\n" for n in range(2))
    drafts = drafts_from_lines(cls, document.splitlines())
    assert [draft.payload(1) for draft in drafts if draft] == [encode(message)] * 2
