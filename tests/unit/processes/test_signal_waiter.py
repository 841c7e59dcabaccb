"""Signals as events."""

import signal

from lcmtools.processes.signal_waiter import SignalWaiter


def test_two_signals_at_once_ask_once():
    with SignalWaiter() as signals:
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGTERM)
        assert signals.pop() == [signal.SIGTERM]
