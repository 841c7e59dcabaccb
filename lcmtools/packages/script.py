"""Running a Python file as Python does, with the modules of message types that nodes can import.

    python -m lcmtools.packages.script FILE [ARGUMENTS...]

Belongs here: the file's ``__main__``, and how its end by an error is reported. Must not know how a
file is found.
"""

import sys
from pathlib import Path
from traceback import print_exception
from types import ModuleType, TracebackType

from lcmtools.message_value import name_fields
from lcmtools.packages.runnable_nodes import in_place_of_ros, provide_imports


def run(path: Path) -> None:
    """Run a file as ``__main__``; its arguments are those of this process."""
    folder = path.resolve().parent
    sys.path[0] = str(folder)
    provide_imports(folder)
    sys.excepthook = _report
    main = sys.modules["__main__"] = ModuleType("__main__")
    main.__file__ = str(path)
    exec(compile(path.read_bytes(), str(path), "exec"), vars(main))  # noqa: S102 - the user's own


def _report(kind: type[BaseException], error: BaseException, frames: TracebackType | None) -> None:
    """Print an error as if Python had run the file, and name what replaces a module of ROS."""
    while frames and frames.tb_frame.f_code.co_filename != sys.argv[0]:
        frames = frames.tb_next
    name_fields(error)
    print_exception(kind, error, frames)
    if isinstance(error, ModuleNotFoundError) and (own := in_place_of_ros(error.name or "")):
        sys.stderr.write(f"{Path(sys.argv[0]).name} imports '{error.name}', as in ROS; {own}\n")


if __name__ == "__main__":
    del sys.argv[0]
    run(Path(sys.argv[0]))
