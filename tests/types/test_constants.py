"""Constants are shown with the types that they are declared with."""

import pytest

from lcmtools import message_class
from lcmtools.messages.definition import definition

MODE = """\
int32 KIND=3
int32 OTHER=16
int8 SMALL=-1
int64 LARGE=5
float32 HALF=0.5
float64 THIRD=0.25
int8 mode
constants/inner_t inner
  int16 KIND=4
  int8 kind"""
LEVEL = """\
uint8 LOW=1
int32 HIGH=2
uint16 FLAGS=3
float32 RATE=0.5
bool ON=1
string NAME=level
uint8 level"""


@pytest.mark.parametrize(("name", "text"), [("mode_t", MODE), ("Level", LEVEL)])
def test_constants_have_their_declared_types(family, name, text):
    family("constants")
    assert definition(message_class(f"constants/{name}")) == text
