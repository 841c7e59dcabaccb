"""Signals that interrupt a command, where Python gives an interrupt no way up."""

import signal
import sys
import threading
import time

import pytest

from lcmtools.cli.ending import interrupting_signals

MOST_SECONDS = 40.0


class Finalized:
    """An object that a signal comes to as it dies; imports have such, by weak references."""

    def __init__(self, number):
        self.number = number

    def __del__(self):
        """Bring the signal."""
        signal.raise_signal(self.number)
        time.sleep(0)  # Python answers a signal with the next line at the latest


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_that_python_ignores_comes_again(number):
    def wait():
        Finalized(number)
        threading.Event().wait(MOST_SECONDS)

    with interrupting_signals() as signals, pytest.raises(KeyboardInterrupt):
        wait()
    assert signals[0] == number


def test_two_signals_at_once_interrupt_a_command_once_so_that_its_clean_up_is_done():
    with interrupting_signals() as signals:
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGTERM)
    assert signals == [signal.SIGTERM]


def test_other_exceptions_that_python_ignores_are_shown_and_nothing_is_left_behind(monkeypatch):
    shown = []
    monkeypatch.setattr(sys, "unraisablehook", lambda ignored: shown.append(ignored.exc_type))
    hook, alarm = sys.unraisablehook, signal.getsignal(signal.SIGALRM)
    with interrupting_signals() as signals:
        Finalized(-1)  # no signal has this number
    assert shown == [OSError]
    assert not signals
    assert (sys.unraisablehook, signal.getsignal(signal.SIGALRM)) == (hook, alarm)
