"""A command line, a node library and robot labs for LCM.

The public names of the node API are here, and ``observe`` and ``publish``. They are imported when
first used: the command line starts without them.
"""

from typing import TYPE_CHECKING

__version__ = "0.1.0"

if TYPE_CHECKING:
    from lcmtools import observe as observe
    from lcmtools import publish as publish
    from lcmtools.errors import LcmtoolsError as LcmtoolsError
    from lcmtools.node.node import Node as Node
    from lcmtools.node.parameters import Parameter as Parameter
    from lcmtools.node.parameters import SetParametersResult as SetParametersResult
    from lcmtools.node.process import init as init
    from lcmtools.node.process import ok as ok
    from lcmtools.node.process import shutdown as shutdown
    from lcmtools.node.process import spin as spin
    from lcmtools.node.process import spin_once as spin_once
    from lcmtools.packages import message_class as message_class

_HOMES = {
    "LcmtoolsError": "lcmtools.errors",
    "Node": "lcmtools.node.node",
    "Parameter": "lcmtools.node.parameters",
    "SetParametersResult": "lcmtools.node.parameters",
    "init": "lcmtools.node.process",
    "message_class": "lcmtools.packages",
    "ok": "lcmtools.node.process",
    "shutdown": "lcmtools.node.process",
    "spin": "lcmtools.node.process",
    "spin_once": "lcmtools.node.process",
}

__all__ = [
    "LcmtoolsError",
    "Node",
    "Parameter",
    "SetParametersResult",
    "__version__",
    "init",
    "message_class",
    "observe",
    "ok",
    "publish",
    "shutdown",
    "spin",
    "spin_once",
]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used (PEP 562)."""
    from importlib import import_module

    if name in ("observe", "publish"):
        return import_module(f"lcmtools.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'lcmtools' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)
