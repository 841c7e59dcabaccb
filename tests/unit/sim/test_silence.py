"""Nothing that C code prints comes through."""

import subprocess
import sys

SCRIPT = """
import ctypes, os, sys
from lcmtools_sim.engines.native import suppressed_output
libc = ctypes.CDLL(None)
print("before")
with suppressed_output():
    libc.printf(b"chatter of C\\n")
    os.write(2, b"chatter on stderr\\n")
    print("chatter of Python")
libc.printf(b"after\\n")
libc.fflush(None)
"""


def run(script, prefix=""):
    command = ["/bin/sh", "-c", f'exec "$0" -c "$1" {prefix}', sys.executable, script]
    return subprocess.run(command, capture_output=True, text=True, timeout=30, check=False)


def test_what_c_and_python_print_within_is_gone_and_the_rest_is_there():
    # stdout is a pipe here, so C buffers it: it must be flushed before it is given back.
    done = run(SCRIPT)
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(done.stdout.split()) == ["after", "before"]


def test_a_program_without_stdout_is_silenced_too():
    done = run(SCRIPT.replace('print("before")', ""), ">&-")
    assert (done.returncode, done.stderr) == (0, "")
