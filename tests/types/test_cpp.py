"""C++ code for types that contain others, with old and new versions of liblcm."""

import shutil
import subprocess
import sysconfig
from pathlib import Path

import pytest

HEADERS = Path(sysconfig.get_path("purelib")) / "include"
NEW, OLD = "int64_t (*v)(void);", "void *v;"  # as in liblcm 1.5 and 1.3.1
PROGRAM = """
#include <geometry_msgs/TwistStamped.hpp>
#include <cstdio>
int main() { std::printf("%016llx", (unsigned long long)geometry_msgs::TwistStamped::getHash()); }
"""


@pytest.mark.parametrize("member", [NEW, OLD])
def test_generated_cpp_compiles_with_every_liblcm(member, tmp_path, cli):
    compiler = shutil.which("g++") or pytest.skip("no g++ to compile C++ programs with")
    headers = Path(shutil.copytree(HEADERS / "lcm", tmp_path / "include" / "lcm"))
    types = (headers / "lcm_coretypes.h").read_text()
    assert NEW in types
    (headers / "lcm_coretypes.h").write_text(types.replace(NEW, member))
    (tmp_path / "main.cpp").write_text(PROGRAM)
    made = cli("msg", "generate", "--lang", "cpp", str(tmp_path), "geometry_msgs/TwistStamped")
    assert made.code == 0
    options = ["-std=c++11", "-Wall", "-Werror", f"-I{tmp_path}", f"-I{headers.parent}"]
    program = tmp_path / "main"
    subprocess.run([compiler, *options, tmp_path / "main.cpp", "-o", program], check=True)
    number = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    assert cli("msg", "fingerprint", "geometry_msgs/TwistStamped").out == f"{number}\n"
