"""NodeArguments as a command line, and back."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.arguments import NodeArguments, split_arguments

NAMES = st.from_regex(r"[a-z][a-z0-9]{0,4}", fullmatch=True)
TEXTS = st.text(min_size=1, max_size=8)


@given(
    st.builds(
        NodeArguments,
        namespace=st.none() | TEXTS,
        name=st.none() | TEXTS,
        remaps=st.lists(st.tuples(NAMES, TEXTS), max_size=3).map(tuple),
        parameters=st.dictionaries(NAMES, TEXTS, max_size=3),
        lcm_url=st.none() | TEXTS,
        domain=st.none() | TEXTS,
    )
)
def test_the_words_of_a_value_are_read_as_it(arguments):
    assert split_arguments(arguments.words()) == (arguments, [])
