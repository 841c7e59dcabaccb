"""What of a sender's messages did not come, in words."""

from lcmtools.observe.losses import Loss, total
from lcmtools.wire.packet import Sender

ONE, OTHER = Sender("10.0.0.1", 40_000), Sender("10.0.0.1", 40_001)


def test_a_loss_is_told_with_its_share() -> None:
    assert str(Loss(12, 120)) == "12 of 120 (10.0 %)"


def test_nothing_sent_is_nothing_lost() -> None:
    assert str(Loss()) == "0 of 0 (0.0 %)"


def test_the_senders_of_a_node_are_taken_together() -> None:
    known = {ONE: Loss(1, 10), OTHER: Loss(2, 30)}
    assert total([ONE, OTHER], known) == Loss(3, 40)


def test_a_sender_of_which_nothing_is_known_lost_nothing() -> None:
    assert total([OTHER], {ONE: Loss(1, 10)}) == Loss()
