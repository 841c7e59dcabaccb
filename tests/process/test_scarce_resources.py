"""Commands for which the system has too little: one line, which says of what."""

import errno
import os
import shlex
import subprocess
import sys

import pytest

from lcmtools.cli.ending import explain

FEW = [
    OSError(errno.EMFILE, os.strerror(errno.EMFILE), "/dev/null"),
    OSError(errno.ENFILE, os.strerror(errno.ENFILE)),
    ImportError(f"mmap.so: cannot open shared object file: {os.strerror(errno.EMFILE)}"),
]
LITTLE = [
    MemoryError(),
    OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)),
    ImportError("_ssl.so: failed to map segment from shared object"),
]


@pytest.mark.parametrize(
    ("error", "what"),
    [
        *((error, "file descriptors; end others; see ulimit -n") for error in FEW),
        *((error, "memory; end others; see ulimit -v") for error in LITTLE),
        (RuntimeError("can't start new thread"), "threads; end others; see ulimit -u and -v"),
    ],
)
def test_what_is_lacking_is_said_in_one_line(error, what, capsys):
    assert explain(error, "lcmtools gui") == 1
    assert capsys.readouterr().err == f"lcmtools gui: the system gives no more {what}\n"


def test_the_cause_of_an_error_counts(capsys):
    error = ValueError("no channel")
    error.__cause__ = MemoryError()
    explain(error, "lcmtools list")
    assert "no more memory" in capsys.readouterr().err


@pytest.mark.parametrize("descriptors", [6, 8, 10])
def test_a_window_with_few_descriptors_says_so(descriptors, bus_url):
    window = f"{shlex.quote(sys.executable)} -m lcmtools gui all --no-open --port 0"
    result = subprocess.run(
        ["/bin/sh", "-c", f"ulimit -n {descriptors}; exec timeout --signal INT 4 {window}"],
        env={**os.environ, "LCM_DEFAULT_URL": bus_url},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert "Traceback" not in result.stderr, result
    assert "a fault of" not in result.stderr, result
    assert "no more file descriptors" in result.stderr or "http://" in result.stdout + result.stderr
