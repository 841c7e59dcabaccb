"""Payloads that are not LCM messages: detecting their most likely format.

Belongs here: telling formats apart by the bytes of a whole payload or of its head. Must not know
types: payloads with a known fingerprint do not come here.
"""

import re

_MAGIC = {
    b"\x89PNG\r\n": "a PNG image",
    b"\xff\xd8\xff": "a JPEG image",
    b"\x1f\x8b": "data compressed by gzip",
    b"\x00\x01\x00\x00": "CDR, as ROS 2 and DDS send it",
}
_PICKLE = re.compile(rb"\x80[\x02-\x05]")
_UNPRINTABLE = re.compile("[\x00-\x08\x0e-\x1a\x1c-\x1f\x7f\ufffd]")  # except terminal escapes
_JSON_HEAD = re.compile(r"""\s*(?:\{\s*["}]|\[\s*["\[{\]tfn\d-])""")
_SHORTEST = 8  # bytes of an LCM message: its fingerprint
_MOST_FIELD = 2047  # the largest field number of protobuf in two bytes; real ones are smaller
_MOST_FIELDS = 10_000  # that are checked
_FIXED = {1: 8, 5: 4}  # protobuf's wire types of fixed size [byte]


def foreign_format(payload: bytes, *, is_whole: bool = True) -> str:
    """Guess the format of a payload of unknown fingerprint: "JSON", "protobuf", "text", ...

    Returns "" for a payload that may be an LCM message of an unknown type. ``is_whole`` is False
    if the end of the payload is not available.
    """
    if not payload:
        return "nothing (no bytes)"
    if text_format := _text_format(payload, is_whole=is_whole):
        return text_format
    for magic, name in _MAGIC.items():
        if payload.startswith(magic):
            return name
    if _PICKLE.match(payload) and (payload.endswith(b".") or not is_whole):
        return "a pickle of Python"
    if _is_protobuf(payload, is_whole=is_whole):
        return "protobuf"
    return "" if len(payload) >= _SHORTEST else f"{len(payload)} bytes"


def _text_format(payload: bytes, *, is_whole: bool) -> str:
    import json

    try:
        text = payload.rstrip(b"\0").decode()
    except UnicodeDecodeError as error:
        if is_whole or error.start < len(payload) - 3:  # the last character may be cut off
            return ""
        text = payload[: error.start].decode()
    if not text or _UNPRINTABLE.search(text):
        return ""
    if _JSON_HEAD.match(text):
        try:
            json.loads(text)
        except (ValueError, RecursionError):
            return "text" if is_whole else "JSON"
        return "JSON"
    return "XML" if text.lstrip().startswith("<") else "text"


def _is_protobuf(data: bytes, *, is_whole: bool) -> bool:
    """Return True if the bytes are protobuf fields up to their end, in ascending order.

    The format: https://protobuf.dev/programming-guides/encoding
    """
    if len(data) == _SHORTEST + 1 and data[0] & 7 == 1:
        return False  # a single 8-byte number: a fingerprint and one byte are as likely
    at, last = 0, 1
    for _ in range(_MOST_FIELDS):
        tag, start = _varint(data, at)
        number, kind = tag >> 3, tag & 7
        if not last <= number <= _MOST_FIELD or kind not in (0, 1, 2, 5):
            return False
        last = number
        size, start = _varint(data, start) if kind in (0, 2) else (_FIXED[kind], start)
        at = start + (size if kind else 0)
        if start < 0 or at >= len(data):
            return at == len(data) or (not is_whole and start > 0)
    return True


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """Return a variable-length number and the offset of its end; (0, -1) if it does not end."""
    value = 0
    for place, byte in enumerate(data[at : at + 10] if at >= 0 else b""):
        value |= (byte & 127) << 7 * place
        if byte < 128:  # noqa: PLR2004 - the top bit means that more bytes follow
            return value, at + place + 1
    return 0, -1
