"""A shell's question to its answer: what runs when somebody presses TAB.

The only door to completion, silent whatever happens: nothing may be printed into the prompt of
somebody who types. With LCMTOOLS_DEBUG set, what went wrong goes to a file.
"""

import contextlib
import os
import signal
import sys
import time
from collections.abc import Mapping, Sequence

from lcmtools.cli.completion.candidate import FILES, Candidate, shown
from lcmtools.cli.completion.line import Place, locate
from lcmtools.cli.completion.shells import SHELLS, Question
from lcmtools.cli.completion.situation import Situation
from lcmtools.cli.completion.tree import Tree
from lcmtools.cli.completion.words.table import candidates
from lcmtools.packages import provide_user_types

VARIABLE = "_LCMTOOLS_COMPLETE"
"""The environment variable that has a shell's name when the shell asks."""
_LATEST = 2.0  # [s] after which the process ends whatever holds it up


def run() -> None:
    """Answer the question on the command line, and end the process."""
    _be_silent()
    try:
        tree = Tree(os.environ)
        provide_user_types()
        lines = answer(os.environ[VARIABLE], sys.argv[1:], tree)
        with contextlib.suppress(OSError):
            os.write(1, "".join(f"{line}\n" for line in lines).encode("utf-8", "surrogateescape"))
            os.close(1)  # the shell reads on to the end, and what comes now it need not wait for
        tree.keep()
    except BaseException:  # noqa: BLE001 - a prompt is no place for any of them
        _log()
    os._exit(0)  # without waiting for anything


def answer(shell: str, arguments: Sequence[str], tree: Tree) -> list[str]:
    """What a shell gets for its question; see ``shells``.

    Args:
        shell: "bash", "zsh" or "fish"; any other gets nothing.
        arguments: What the shell hands over.
        tree: The commands.
    """
    if shell not in SHELLS:
        return []
    question = SHELLS[shell].read(arguments)
    found = complete(question, tree, os.environ)
    fitting = shown(found, question.word)
    if not fitting and any(one is FILES for one in found):
        return ["files"]
    return SHELLS[shell].write(fitting, question)


def complete(question: Question, tree: Tree, environment: Mapping[str, str]) -> list[Candidate]:
    """The words that could stand at the cursor; some may not begin as the word does."""
    place = locate(question.words, question.word, tree.describe)
    if place is None:
        return []
    if place.kind == "commands":
        return [Candidate(name, text) for name, text in place.command.commands.items()]
    if place.kind == "options":
        return list(_options(place))
    word = question.word[len(place.before) :]
    situation = Situation(place.path, word, place.given, environment)
    found = candidates(place.kind, situation)
    if not place.before:
        return found
    return [
        one if one is FILES else Candidate(f"{place.before}{one.value}", one.help, one.is_open)
        for one in found
    ]


def _options(place: Place) -> list[Candidate]:
    """The options' names: long forms first, as they say more."""
    options = place.unused_options()
    ranked = [(name, one) for one in options for name in one.names]
    ranked.sort(key=lambda pair: not pair[0].startswith("--"))
    return [Candidate(name, one.help) for name, one in ranked]


def _be_silent() -> None:
    """Let nothing reach the terminal, and the process end in time."""
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 2)
    signal.signal(signal.SIGALRM, lambda *_: os._exit(0))
    signal.setitimer(signal.ITIMER_REAL, _LATEST)
    signal.signal(signal.SIGINT, lambda *_: os._exit(0))


def _log() -> None:
    """Write what went wrong to the user's state folder, where that is asked for."""
    if not os.environ.get("LCMTOOLS_DEBUG"):
        return
    import traceback

    from lcmtools.cli.completion.places import home_folder

    folder = home_folder(os.environ, "XDG_STATE_HOME", ".local/state")
    if folder is None:
        return
    with contextlib.suppress(OSError):
        (folder / "lcmtools").mkdir(parents=True, exist_ok=True)
        with (folder / "lcmtools" / "completion.log").open("a", encoding="utf-8") as log:
            log.write(f"{time.strftime('%F %T')} {sys.argv[1:]}\n{traceback.format_exc()}\n")
