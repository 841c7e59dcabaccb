"""Buses: LCM's own, and the one that the shell has chosen."""

from collections.abc import Iterator

from lcmtools.cli.completion.candidate import Candidate
from lcmtools.cli.completion.situation import Situation

_USUAL = "udpm://239.255.76.67:7667?ttl=0"
_PROVIDERS = ("tcpq://", "file://")


def buses(situation: Situation) -> Iterator[Candidate]:
    """The bus of the environment, the default, and how other kinds begin."""
    yield Candidate(situation.environment.get("LCM_DEFAULT_URL") or _USUAL)
    yield Candidate(_USUAL)
    yield from (Candidate(provider, is_open=True) for provider in _PROVIDERS)
