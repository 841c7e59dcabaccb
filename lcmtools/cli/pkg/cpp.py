"""``lcmtools pkg cpp-path``."""

import shlex

from lcmtools.cli.declare import examples, flag, subcommand
from lcmtools.cli.options import json_option
from lcmtools.cli.output import write_result
from lcmtools.errors import UsageError
from lcmtools.packages.cpp import compiler_flags, cpp_folder, find_liblcm, wheel_prefix


@subcommand("cpp-path", json_option)
@examples(
    "pkg cpp-path",
    "pkg cpp-path --flags",
)
@flag("--flags", "with_flags", help="The compiler's flags, liblcm's included.")
@flag("--lcm", "of_lcm", help="The folder of the liblcm that pip has installed.")
def command(*, with_flags: bool, of_lcm: bool, as_json: bool) -> None:
    """Print the folder of the C++ headers and of their CMake package.

    A node is compiled by  g++ node.cpp $(lcmtools pkg cpp-path --flags)  or by CMake, with
    find_package(lcmtools) and -DCMAKE_PREFIX_PATH=$(lcmtools pkg cpp-path). The system's liblcm is
    used, or else the one that the Python package lcm brings.
    """
    if with_flags and of_lcm:
        raise UsageError("--flags and --lcm are two questions", "ask one at a time")
    folder = cpp_folder()
    if as_json:
        record = {
            "folder": str(folder),
            "pkg_config": str(folder / "pkgconfig"),
            "liblcm": find_liblcm().prefix or None,
            "flags": compiler_flags(),
        }
        write_result(record, [], as_json=True)
        return
    line = str(wheel_prefix()) if of_lcm else str(folder)
    write_result({}, [shlex.join(compiler_flags()) if with_flags else line], as_json=False)
