"""The ways of a message into a payload, text and JSON and back.

Every type takes them with its default values; with any values those types do that have, together,
every kind of field that there is.
"""

import copy
import json
import math
import pickle
import struct

import pytest
from fixtures.message_classes import check_constructor, check_values
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lcmtools.errors import DecodeError
from lcmtools.message_value import MessageValue
from lcmtools.messages.array_codec import Cursor, Malformed
from lcmtools.messages.codec import PayloadEncoder, decode, encode
from lcmtools.messages.coder import coder
from lcmtools.messages.definition import definition
from lcmtools.messages.dicts import from_dict, to_dict
from lcmtools.messages.fields import fields, visible_fields
from lcmtools.messages.fill import fill
from lcmtools.messages.foreign import foreign_format
from lcmtools.messages.message_template import draft_from_values
from lcmtools.messages.path import Path, select
from lcmtools.messages.plain import plain_value, to_json, to_plain
from lcmtools.messages.registry import candidates, fingerprint, message_class, type_name
from lcmtools.messages.scalars import INTEGERS
from lcmtools.messages.text import FREE, format_message
from lcmtools.types.fingerprints import FINGERPRINTS

LONGEST = 3
DEEPEST = 3

FEW = settings(
    max_examples=10,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
# NaN has many bit patterns and one text
SCALARS = {
    "bool": st.booleans(),
    "string": st.text(max_size=8),
    "float32": st.floats(width=32, allow_nan=False) | st.just(math.nan),
    "float64": st.floats(width=64, allow_nan=False) | st.just(math.nan),
    **{name: st.integers(low, high) for name, (low, high) in INTEGERS.items()},
}


@st.composite
def messages(draw, cls, depth=0):
    """Messages of a type with any values, as a user would make them."""
    message = cls()
    longest = LONGEST if depth < DEEPEST else 0
    sizes = {f.name: draw(st.integers(0, longest)) for f in fields(cls) if f.is_length}
    for field in visible_fields(cls):
        counts = [sizes[size] if isinstance(size, str) else size for size in field.dimensions]
        setattr(message, field.name, draw(values(field, counts, depth)))
    return message


def values(field, counts, depth):
    """Values of a field: one, or an array of the given sizes."""
    if len(counts) == 1 and field.is_bytes:
        return st.binary(min_size=counts[0], max_size=counts[0])
    if counts:
        inner = values(field, counts[1:], depth)
        if counts[0] > 2 * LONGEST:  # a covariance of 36 equal numbers draws faster
            return inner.map(lambda value: [value] * counts[0])
        return st.lists(inner, min_size=counts[0], max_size=counts[0])
    if field.message_class:
        return messages(field.message_class, depth + 1)
    return SCALARS[field.type]


def comparable(message):
    """Everything in a message, such that equal means equal to the bit."""

    def bits(value):
        if isinstance(value, dict):
            return {name: bits(part) for name, part in value.items()}
        if isinstance(value, list):
            return [bits(part) for part in value]
        return struct.pack("d", value) if isinstance(value, float) else value

    return bits(to_plain(message))


def check_round_trips(message):
    """A payload, text and JSON give the message back; lcm-gen's and the careful decoder agree."""
    cls = type(message)
    payload = encode(message)
    decoded = decode(cls, payload)
    assert encode(decoded) == payload
    assert comparable(coder(cls).read(Cursor(payload, 8))) == comparable(decoded)
    encoder = PayloadEncoder(cls)
    assert [encoder.encode(message), encoder.encode(message), message.encode()] == 3 * [payload]
    assert comparable(decoded) == comparable(cls.decode(payload))
    for text in (format_message(decoded), to_json(decoded)):
        assert encode(draft_from_values(cls, [text]).message) == payload
    again = cls()
    fill(again, to_plain(decoded))
    assert encode(again) == payload
    check_is_a_value(message, decoded)


def check_is_a_value(message, decoded):
    """Dicts, copies and pickles give the message back; equal bytes mean equal messages."""
    cls, payload = type(message), encode(message)
    copies = [copy.deepcopy(decoded), from_dict(cls, to_dict(decoded))]
    if isinstance(message, MessageValue):  # the classes of lcm-gen itself are in no module
        copies += [pickle.loads(pickle.dumps(decoded, number)) for number in range(6)]  # noqa: S301 - ours
        by_name = {field.attribute: getattr(decoded, field.attribute) for field in fields(cls)}
        copies.append(cls(**by_name))
        if "nan" not in format_message(decoded):
            assert [message, *copies] == [decoded] * (1 + len(copies))
        assert repr(decoded).startswith(f"{cls.__name__}(")
    assert [encode(one) for one in copies] == [payload] * len(copies)


def check_broken_payloads(message, change):
    """A part of a payload gives a DecodeError, a spoiled one what the careful decoder says."""
    cls, payload = type(message), encode(message)
    for size in range(len(payload)):
        with pytest.raises(DecodeError):
            decode(cls, payload[:size])
    spoiled = payload[:8] + change(payload[8:])
    try:
        decoded = decode(cls, spoiled)
    except DecodeError:
        with pytest.raises(Malformed):
            coder(cls).read(Cursor(spoiled, 8))
        return
    assert comparable(coder(cls).read(Cursor(spoiled, 8))) == comparable(decoded)
    format_message(decoded)
    encode(decoded)


@st.composite
def changes(draw):
    """Functions that spoil some bytes."""
    spoiled = draw(st.lists(st.tuples(st.floats(0, 1), st.integers(0, 255)), max_size=4))

    def change(data):
        result = bytearray(data)
        for place, value in spoiled:
            if result:
                result[int(place * (len(result) - 1))] = value
        return bytes(result)

    return change


def kinds(name):
    """The kinds of fields that a type has: scalar, message or array, of fixed or variable size."""
    return frozenset(
        (
            "message" if field.message_class else field.type,
            *(isinstance(size, str) or size > LONGEST for size in field.dimensions),
            field.is_length,
        )
        for field in fields(message_class(name))
    )


def covering():
    """Few types that have, together, every kind of field."""
    by_name = {name: kinds(name) for name in sorted(FINGERPRINTS)}
    left, chosen = set().union(*by_name.values()), []
    while left:
        chosen.append(max(by_name, key=lambda name: len(by_name[name] & left)))
        left -= by_name[chosen[-1]]
    return chosen


@pytest.mark.parametrize("name", covering())
def test_any_values_survive_payload_text_and_json(name):
    @FEW
    @given(messages(message_class(name)))
    def check(message):
        check_round_trips(message)

    check()


@pytest.mark.parametrize("name", covering())
def test_broken_payloads_are_refused(name):
    @FEW
    @given(messages(message_class(name)), changes())
    def check(message, change):
        check_broken_payloads(message, change)

    check()


@pytest.mark.parametrize("check", [check_values, check_constructor])
def test_every_type_is_a_class_of_values(check, subtests):
    for name in FINGERPRINTS:
        with subtests.test(name):
            check(message_class(name))


def test_every_default_message_survives_and_has_a_definition(subtests):
    for name in FINGERPRINTS:
        with subtests.test(name):
            check_default_message(message_class(name)())


def check_default_message(message):
    cls, payload = type(message), encode(message)
    check_round_trips(message)
    assert len(definition(cls).splitlines()) >= len(visible_fields(cls))
    json.loads(to_json(message))
    decoded, end = coder(cls).scan(payload, 8)  # needs no careful decoder
    assert end == len(payload)
    found = select(decoded, Path())
    plain = plain_value(found.value, found.target)
    assert plain == to_plain(message)
    assert FREE.block(plain).splitlines() == format_message(decoded).splitlines()
    assert foreign_format(payload) == ""
    for size in range(len(payload)):
        with pytest.raises(DecodeError):
            decode(cls, payload[:size])


def test_every_type_has_its_name_and_its_fingerprint(subtests):
    for name, number in FINGERPRINTS.items():
        with subtests.test(name):
            cls = message_class(name)
            assert type_name(cls) == type_name(cls()) == name
            assert fingerprint(cls) == number
            assert name in candidates(number)


@pytest.mark.parametrize(
    "name", ["Shapes", "Shared", "Tree", "Limits", "Many", "Kinds", "Keyed", "Rows"]
)
def test_odd_types_survive_too(odd, name):
    @FEW
    @given(messages(getattr(odd, name)), changes())
    def check(message, change):
        check_broken_payloads(message, change)
        if name != "Shapes" or message.grid:
            check_round_trips(message)

    check()
