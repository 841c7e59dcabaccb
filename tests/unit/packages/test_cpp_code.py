"""The C++ that lcm-gen does not write."""

from lcmtools.packages.lcm_gen import with_lengths
from lcmtools.packages.lcm_parser import parse

HEADER = "class grid_t {\n        // LCM support functions. Users should not call these\n};\n"


def test_a_struct_names_its_arrays_with_their_lengths_and_its_structs():
    text = "int32_t n; double a[n][3]; byte raw[4]; item_t one; item_t two[2]; string s;"
    (grid,) = parse(f"struct grid_t {{ {text} }}")
    calls = [line.strip() for line in with_lengths(HEADER, grid.fields).splitlines()]
    assert [line for line in calls if line.startswith("check(")] == [
        'check("a", this->a, this->n, 3);',
        'check("one", this->one);',
        'check("two", this->two);',
    ]


def test_a_struct_of_numbers_is_as_lcm_gen_writes_it():
    (plain,) = parse("struct plain_t { int32_t n; double a[3]; }")
    assert with_lengths(HEADER, plain.fields) == HEADER
