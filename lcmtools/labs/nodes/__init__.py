"""The labs' nodes, one file each: the model answers, as short as possible.

They use the public node API only and know nothing of the command line ``lcmtools``, so that they
can be copied and changed. A file's docstring is also what its ``--help`` prints.
"""

import sys
from collections.abc import Sequence

from lcmtools.arguments import misspelt, split_arguments
from lcmtools.errors import UsageError
from lcmtools.names import did_you_mean

_EVERY_NODE_TAKES = """\
Every node also takes:
    __ns:=/husky0       its namespace                       (--ns /husky0)
    __name:=driver      another name                        (--name driver)
    chatter:=/news      another topic in place of chatter   (--remap chatter:=/news)
    _parameter:=value   a parameter's value                 (--param parameter:=value)
    --lcm-url URL       the bus
    --domain N          the bus on port 7667 + N"""


def check_command_line(args: Sequence[str] | None, help_text: str | None) -> bool:
    """Check the command line of a node without own arguments, before a bus is opened.

    Returns:
        True if the node should run; False if ``--help`` was given and printed.

    Raises:
        UsageError: An argument is wrong or unknown.
    """
    unknown = own_arguments(args, help_text)
    if unknown:
        raise unknown_argument(args, unknown[0])
    return unknown is not None


def own_arguments(args: Sequence[str] | None, help_text: str | None) -> list[str] | None:
    """Return the node's own arguments; None if ``--help`` was given and printed.

    ``args`` is the command line without the program's name, else that of ``sys.argv``;
    ``help_text`` the node's own help: its purpose, its topics, an example; None if Python has
    dropped docstrings (-OO, PYTHONOPTIMIZE=2).

    Raises:
        UsageError: An argument for every node is wrong.
    """
    words = sys.argv[1:] if args is None else args
    if "--help" in words or "-h" in words:
        print((help_text or "").strip(), _EVERY_NODE_TAKES, sep="\n\n")  # noqa: T201 - a node's own output
        return None
    return split_arguments(words)[1]


def unknown_argument(
    args: Sequence[str] | None, word: str, flags: Sequence[str] = ()
) -> UsageError:
    """Return the error for an argument that is unknown to a node with these flags."""
    words = sys.argv[1:] if args is None else args
    hint = misspelt(words, word) or did_you_mean(word, flags) or "--help shows what this node takes"
    return UsageError(f"unknown argument '{word}'", hint)
