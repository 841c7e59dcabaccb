"""The console script, and ``python -m lcmtools``.

It imports little: importing the command line takes a moment, and Ctrl-C must be quiet from the
start. A shell's request for completion is answered without the command line.
"""

import gc
import os
import signal
import sys

_NEW_OBJECTS = 100_000
"""The number of new objects before a garbage collection; Python's default is 700.

Imports create many times more. Searching them for garbage, now and at the end of the process, takes
a tenth of a short command's time.
"""


def _end_if_interrupted(ignored: "sys.UnraisableHookArgs") -> None:
    """End the process at a Ctrl-C that Python would ignore because it interrupted an import."""
    if ignored.exc_type is KeyboardInterrupt:
        os._exit(130)
    sys.__unraisablehook__(ignored)


def run() -> None:
    """Run the command line and end the process."""
    gc.set_threshold(_NEW_OBJECTS)
    sys.unraisablehook = _end_if_interrupted
    try:
        # launch starts its nodes with SIGINT blocked: an earlier one arrives now
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        if "_LCMTOOLS_COMPLETE" in os.environ:
            from lcmtools.cli.completion.answer import run as answer

            answer()
        from lcmtools.cli.main import run as run_command_line

        run_command_line()
    except KeyboardInterrupt as interrupt:
        sys.stderr.flush()
        # the command line is not imported yet: nothing is open that would need closing
        os._exit(interrupt.args[0] if interrupt.args else 130)


if __name__ == "__main__":
    run()
