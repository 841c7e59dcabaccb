"""Loss by the senders' own numbers."""

from hypothesis import given
from hypothesis import strategies as st

from lcmtools.wire.sequence import Sequence


def sequence(*numbers):
    one = Sequence()
    for number in numbers:
        one.add(number)
    return one


def test_numbers_without_gap_are_no_loss():
    assert sequence(*range(7, 100)).lost == 0


def test_a_gap_is_loss():
    assert sequence(0, 1, 5, 6, 8).lost == 4


def test_what_comes_late_is_not_lost():
    assert sequence(0, 1, 5, 3, 4, 2, 6).lost == 0


def test_what_comes_twice_changes_nothing():
    assert sequence(0, 1, 1, 3, 3, 2, 2).lost == 0


def test_the_counter_goes_around():
    assert sequence(0xFFFFFFFE, 0xFFFFFFFF, 1, 2).lost == 1


def test_numbers_that_begin_anew_are_no_loss():
    one = sequence(5000, 5001, 0, 1, 2)
    assert (one.lost, one.restarts) == (0, 1)
    again = sequence(100, 2_000_000_000, 2_000_000_001)
    assert (again.lost, again.restarts) == (0, 1)


def test_what_never_becomes_whole_is_lost_once_a_later_one_begins():
    one = sequence(1)
    one.begin(2)
    assert one.lost == 0  # more of it may come
    one.begin(3)
    assert one.lost == 1
    one.add(3)
    one.begin(4)
    one.begin(4)
    one.add(4)
    assert (one.messages, one.lost) == (3, 1)
    one.add(2)
    assert (one.messages, one.lost) == (4, 0)


@given(st.sets(st.integers(0, 400)), st.integers(0, 2**32 - 1), st.randoms(use_true_random=False))
def test_loss_is_what_is_missing_between_first_and_last(missing, start, chance):
    missing -= {0, 400}
    numbers = [n for n in range(401) if n not in missing]
    for place in range(1, len(numbers) - 2):  # neighbours overtake each other
        if chance.random() < 0.2:
            numbers[place], numbers[place + 1] = numbers[place + 1], numbers[place]
    one = sequence(*((start + n) % 2**32 for n in numbers))
    assert (one.messages, one.lost) == (len(numbers), len(missing))


@given(st.lists(st.integers(0, 2**32 - 1)))
def test_any_numbers_are_counted(numbers):
    one = sequence(*numbers)
    assert one.messages == len(numbers)
    assert one.lost >= 0


def test_small_messages_between_the_parts_of_a_large_one_lose_nothing():
    one = sequence(0)
    one.begin(1)
    for number in range(2, 102):
        one.add(number)
    found = [one.lost]
    for number in (102, 1):
        one.add(number)
        found.append(one.lost)
    assert found == [0, 1, 0]


def test_a_large_message_that_stays_incomplete_is_lost_when_another_begins():
    one = sequence(0)
    one.begin(1)
    one.add(2)
    one.begin(3)
    assert one.lost == 1
