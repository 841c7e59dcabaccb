"""The console script, and ``python -m lcmtools``.

As small as it is because importing the command line takes a moment, in which Ctrl-C should be as
quiet as at any other. A shell that asks for completion gets it without the command line.
"""

import gc
import os
import sys

_NEW_OBJECTS = 100_000
"""From one search for garbage to the next; usual are 700, of which an import makes many times more.

Searching what is imported, here and as the process ends, takes a tenth of a short command's time.
"""


def _end_if_interrupted(ignored: "sys.UnraisableHookArgs") -> None:
    """End the process by a Ctrl-C that Python would ignore: it came in a clean-up of an import."""
    if ignored.exc_type is KeyboardInterrupt:
        os._exit(130)
    sys.__unraisablehook__(ignored)


def run() -> None:
    """Run the command line and end the process."""
    gc.set_threshold(_NEW_OBJECTS)
    sys.unraisablehook = _end_if_interrupted
    try:
        if "_LCMTOOLS_COMPLETE" in os.environ:
            from lcmtools.cli.completion.answer import run as answer

            answer()
        from lcmtools.cli.main import run as run_command_line

        run_command_line()
    except KeyboardInterrupt as interrupt:
        sys.stderr.flush()
        # the interpreter is half started: nothing is open that would need closing
        os._exit(interrupt.args[0] if interrupt.args else 130)


if __name__ == "__main__":
    run()
