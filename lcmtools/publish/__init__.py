"""Publishing for commands and scripts: values from YAML, files or streams; services, parameters.

Nothing here prints or knows a command line. ``publish`` is what ``lcmtools pub`` does.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lcmtools.publish.publication import publish as publish

__all__ = ["publish"]


def __getattr__(name: str) -> object:
    """Import ``publish`` when it is first used (PEP 562)."""
    if name != "publish":
        raise AttributeError(f"module 'lcmtools.publish' has no attribute '{name}'")
    from lcmtools.publish.publication import publish

    return publish
