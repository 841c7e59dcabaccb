"""Compiled programs, once per run of the tests; where g++ is missing, the tests are skipped."""

import fcntl
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from lcmtools.packages.cmake import compiler_flags, cpp_folder

PROGRAMS = Path(__file__).parent / "programs"


def _once(folder, make):
    """Make something unless another worker of pytest-xdist has done so."""
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "made").exists():
            make()
            (folder / "made").touch()


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """A folder for this run that all workers share."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if "PYTEST_XDIST_WORKER" in os.environ else own


@pytest.fixture(scope="session")
def compiler():
    """A C++ compiler."""
    return shutil.which("g++") or pytest.skip("no g++ to compile C++ programs with")


@pytest.fixture(scope="session")
def compiled(built):
    """``compiled("name", *command)``: the program that a compiler makes."""

    def compile_once(name, *command):
        program = built / f"cpp-{name}" / name
        _once(program.parent, lambda: _run(*command, "-o", program))
        return program

    return compile_once


@pytest.fixture(scope="session")
def tables(compiled, compiler):
    """The program tables.cpp, compiled with the flags that ``pkg cpp-path --flags`` prints."""
    warnings = ("-O0", "-Wall", "-Wextra", "-Werror")
    return compiled("tables", compiler, *warnings, PROGRAMS / "tables.cpp", *compiler_flags())


@pytest.fixture(scope="session")
def node_program(built, compiler, lcmtools_path):
    """The program node.cpp, built by CMake with ``find_package(lcmtools)``."""
    del compiler
    cmake = shutil.which("cmake") or pytest.skip("no cmake to build C++ programs with")
    folder = built / "cpp-node"
    options = (f"-DCMAKE_PREFIX_PATH={cpp_folder()}", f"-DLCMTOOLS_PROGRAM={lcmtools_path}")

    def make():
        _run(cmake, "-S", PROGRAMS, "-B", folder, "-DCMAKE_CXX_FLAGS=-O0", *options)
        _run(cmake, "--build", folder)

    _once(folder, make)
    return folder / "node"


def _run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
