"""A command line, a node library and robot labs for LCM.

The public names of the node API, ``bag``, ``observe`` and ``publish`` are available here. Each is
imported on first use, so that the command line starts without them.
"""

import sys
from typing import TYPE_CHECKING

__version__ = "0.1.0"

if TYPE_CHECKING:
    from lcmtools import bag as bag
    from lcmtools import observe as observe
    from lcmtools import publish as publish
    from lcmtools.errors import LcmtoolsError as LcmtoolsError
    from lcmtools.messages.dicts import from_dict as from_dict
    from lcmtools.messages.dicts import to_dict as to_dict
    from lcmtools.node.node import Node as Node
    from lcmtools.node.parameters import Parameter as Parameter
    from lcmtools.node.parameters import SetParametersResult as SetParametersResult
    from lcmtools.node.process import init as init
    from lcmtools.node.process import ok as ok
    from lcmtools.node.process import shutdown as shutdown
    from lcmtools.node.spinning import spin as spin
    from lcmtools.node.spinning import spin_in_background as spin_in_background
    from lcmtools.node.spinning import spin_once as spin_once
    from lcmtools.node.spinning import spin_until_future_complete as spin_until_future_complete
    from lcmtools.packages import message_class as message_class

_HOMES = {
    "LcmtoolsError": "lcmtools.errors",
    "Node": "lcmtools.node.node",
    "Parameter": "lcmtools.node.parameters",
    "SetParametersResult": "lcmtools.node.parameters",
    "message_class": "lcmtools.packages",
    **dict.fromkeys(("from_dict", "to_dict"), "lcmtools.messages.dicts"),
    **dict.fromkeys(("init", "ok", "shutdown"), "lcmtools.node.process"),
    **dict.fromkeys(
        ("spin", "spin_in_background", "spin_once", "spin_until_future_complete"),
        "lcmtools.node.spinning",
    ),
}

__all__ = [
    "LcmtoolsError",
    "Node",
    "Parameter",
    "SetParametersResult",
    "__version__",
    "bag",
    "from_dict",
    "init",
    "message_class",
    "observe",
    "ok",
    "publish",
    "shutdown",
    "spin",
    "spin_in_background",
    "spin_once",
    "spin_until_future_complete",
    "to_dict",
]


class _MissingNames:
    """The last finder of modules: names what was meant by an import that lcmtools lacks."""

    @staticmethod
    def find_spec(name: str, _path: object = None, _target: object = None) -> None:
        """Raise ImportError with a hint; return None if there is none."""
        above, _, short = name.rpartition(".")
        if above.partition(".")[0] == "lcmtools":
            from lcmtools.messages.missing_names import import_hint

            if hint := import_hint(above, short):
                raise ImportError(f"cannot import '{short}' from '{above}': {hint}", name=above)


if not any(getattr(one, "__module__", "") == __name__ for one in sys.meta_path):
    sys.meta_path.append(_MissingNames)


def __getattr__(name: str) -> object:
    """Import a public name on first use (PEP 562)."""
    from importlib import import_module

    if name in ("bag", "observe", "publish"):
        return import_module(f"lcmtools.{name}")
    if name not in _HOMES:
        from lcmtools.ros_words.python_names import FUNCTIONS

        if name in FUNCTIONS:  # "from lcmtools import ..." would hide an AttributeError
            from lcmtools.errors import UsageError

            raise UsageError(f"lcmtools has no '{name}'", f"write {FUNCTIONS[name]}")
        from lcmtools.messages.missing_names import import_hint

        hint = import_hint("lcmtools", name)
        raise AttributeError(f"module 'lcmtools' has no attribute '{name}'{hint and f'; {hint}'}")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)  # found at once next time
    return value
