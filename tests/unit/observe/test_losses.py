"""Losses of a sender, in words."""

from lcmtools.observe.reading.losses import Loss, losses, total
from lcmtools.wire.packet import Sender
from lcmtools.wire.sequence import Sequence

ONE, OTHER = Sender("10.0.0.1", 40_000), Sender("10.0.0.1", 40_001)


def test_a_loss_is_told_with_its_share():
    assert str(Loss(12, 120)) == "12 of 120 (10.0 %)"


def test_nothing_sent_is_nothing_lost():
    assert str(Loss()) == "0 of 0 (0.0 %)"


def test_the_senders_of_a_node_are_taken_together():
    known = {ONE: Loss(1, 10), OTHER: Loss(2, 30)}
    assert total([ONE, OTHER], known) == Loss(3, 40)


def test_a_sender_without_numbers_has_no_loss():
    assert total([OTHER, None], {ONE: Loss(1, 10)}) is None


def test_losses_are_counted_from_the_senders_numbers_and_since_an_earlier_count():
    numbers = {ONE: Sequence()}
    for number in (0, 2, 3):
        numbers[ONE].add(number)
    before = losses(numbers)
    assert before == {ONE: Loss(1, 4)}
    for number in (4, 6, 7):
        numbers[ONE].add(number)
    assert losses(numbers) == {ONE: Loss(2, 8)}
    assert losses(numbers, before) == {ONE: Loss(1, 4)}


def test_numbers_that_begin_again_and_again_are_those_of_several_programs():
    numbers = Sequence()
    for number in (0, 5, 0, 5, 0, 5):
        numbers.add(number)
    assert numbers.is_shared


def test_losses_are_counted_while_a_sender_is_added():
    class Growing(Sequence):
        @property
        def lost(self):
            numbers[OTHER] = Sequence()
            return 0

    numbers = {ONE: Growing()}
    assert losses(numbers) == {ONE: Loss()}
