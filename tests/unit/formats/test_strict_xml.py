"""XML as elements: lines, text, limits, and the hints for common mistakes."""

import pytest

from lcmtools.errors import InvalidFile
from lcmtools.formats.strict_xml import DEEPEST, Element, read_xml


def test_elements_have_their_lines_attributes_and_text():
    root = read_xml('<a x="1">t\n<b/>u<c>v</c>\n</a>', "f", Element)
    assert (root.tag, root.place, root.attributes) == ("a", "f:1", {"x": "1"})
    assert root.text.split() == ["t", "u"]
    assert [(child.tag, child.line, child.text) for child in root.children] == [
        ("b", 2, ""),
        ("c", 2, "v"),
    ]


def test_encoding_is_the_files_own_for_bytes():
    content = '<?xml version="1.0" encoding="latin-1"?><a x="é"/>'
    assert read_xml(content.encode("latin-1"), "f", Element).attributes == {"x": "é"}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("<a>\n<b></a>", "f:2: not XML: mismatched tag; is the <b> of line 2 closed? </b>, or"),
        ("<a x=\u201c1\u201d/>", "f:1: not XML: not well-formed (invalid token); write straight"),
        (
            "<!DOCTYPE a [<!ENTITY b 'c'>]><a/>",
            "f:1: a document type (<!DOCTYPE>) is not supported",
        ),
        ("<a>" * (DEEPEST + 1), f"f:1: nested more than {DEEPEST} levels deep"),
        ('<?xml version="1.0" encoding="klingon"?><a/>', "f:1: not XML: unknown encoding"),
    ],
)
def test_a_mistake_is_named_with_file_and_line(text, complaint):
    with pytest.raises(InvalidFile) as caught:
        read_xml(text.encode(), "f", Element)
    assert str(caught.value).startswith(complaint)
