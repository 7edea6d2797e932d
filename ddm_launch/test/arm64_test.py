# Sources of each core library compile for arm64 with the settings of all packages and without headers of ROS.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import shutil
import subprocess

import pytest

from rooms import CHECKOUT

COMPILER = "aarch64-linux-gnu-g++"
# These files contain the vectorised arctan, the threads of the objective and the clock of the planner.
SOURCES = ["ddm_sim/src/pendulum.cpp", "ddm_model/src/arctan.cpp", "ddm_model/src/objective.cpp", "ddm_mpc/src/planner.cpp"]
FOLDERS = ["ddm_sim", "ddm_model", "ddm_mpc", "ddm_msgs/common"]
# The project only compiles: libraries to link with exist for this machine alone, but headers are the same for both.
PROJECT = """
cmake_minimum_required(VERSION 3.16)
project(arm64 CXX)
include({checkout}/ddm_msgs/cmake/ddm_build.cmake)
find_package(Eigen3 3.3 REQUIRED NO_MODULE)
add_library(cores OBJECT {sources})
target_include_directories(cores PRIVATE {includes})
target_compile_options(cores PRIVATE -fopenmp)
target_link_libraries(cores PRIVATE Eigen3::Eigen)
"""
ELF_AARCH64 = (183).to_bytes(2, "little")


def run(*command):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True)
    assert done.returncode == 0, done.stdout[-5000:]


@pytest.mark.skipif(not shutil.which(COMPILER), reason="%s is not installed" % COMPILER)
def test_sources_of_the_cores_become_objects_without_flags_of_another_processor(tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(PROJECT.format(
        checkout=CHECKOUT, sources=" ".join(os.path.join(CHECKOUT, path) for path in SOURCES),
        includes=" ".join(os.path.join(CHECKOUT, folder, "include") for folder in FOLDERS)))
    build = str(tmp_path / "build")
    # The build does not optimise, because optimising would take much longer.
    run("cmake", "-S", str(tmp_path), "-B", build, "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_COMPILER=" + COMPILER,
        "-DCMAKE_SYSTEM_NAME=Linux", "-DCMAKE_SYSTEM_PROCESSOR=aarch64")
    with open(os.path.join(build, "CMakeFiles", "cores.dir", "flags.make")) as stream:
        flags = stream.read()
    assert "-Wextra" in flags  # the settings of all packages are used
    assert re.findall(r"-m(?:arch|cpu|tune|avx|sse|fma)\S*", flags) == []
    run("cmake", "--build", build, "--parallel", str(os.cpu_count()))
    objects = glob.glob(os.path.join(build, "**", "*.cpp.o"), recursive=True)
    assert len(objects) == len(SOURCES)
    for path in objects:
        with open(path, "rb") as stream:
            assert stream.read(20)[18:] == ELF_AARCH64, path
