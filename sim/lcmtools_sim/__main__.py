"""Simulate robots, walls and boxes, steered and watched by topics.

The simulator's command: ``lcmtools run sim``, ``lcmtools-sim``, ``python -m lcmtools_sim``.

This is the edge: printing and exit codes. Without the extra ``sim`` it says so.
"""

import sys
from collections.abc import Sequence

from lcmtools.errors import LcmtoolsError, needing_extra
from lcmtools.escapes import ESCAPES


def main(args: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code; ``args`` without the program's name."""
    try:
        with needing_extra("sim", "the simulator needs"):
            from lcmtools_sim.main import run
        return run(list(sys.argv[1:] if args is None else args))
    except LcmtoolsError as error:
        line = f"lcmtools run sim: {error}".translate(ESCAPES)
        print(line, file=sys.stderr)  # noqa: T201 - the command's edge
        return error.exit_code
    except KeyboardInterrupt:
        return 0


if __name__ == "__main__":
    sys.exit(main())
