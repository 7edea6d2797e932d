# The core libraries compile for arm64, with the build settings of all packages and with no header of ROS.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import shutil
import subprocess
import unittest

from scratch_case import ScratchCase

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
COMPILER = "aarch64-linux-gnu-g++"
CORES = ["ddm_sim", "ddm_model", "ddm_mpc", "ddm_mpc/pilco"]
# Objects only: libraries to link with exist for this machine alone, but headers are the same on all.
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


@unittest.skipUnless(shutil.which(COMPILER), "%s is not installed" % COMPILER)
class Arm64Test(ScratchCase):
    def assertRuns(self, *command):
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)
        self.assertEqual(done.returncode, 0, done.stdout[-5000:])

    def test_all_sources_of_the_cores_become_objects_without_flags_of_another_processor(self):
        sources = [path for core in CORES for path in glob.glob(os.path.join(CHECKOUT, core, "src", "*.cpp"))]
        self.assertGreater(len(sources), 40)
        includes = [os.path.join(CHECKOUT, folder, "include") for folder in CORES + ["ddm_msgs/params", "ddm_msgs/random"]]
        self.write("CMakeLists.txt", PROJECT.format(checkout=CHECKOUT, sources=" ".join(sources), includes=" ".join(includes)))
        build = self.file("build")
        # without optimisation, which takes a while
        self.assertRuns("cmake", "-S", self.scratch, "-B", build, "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_COMPILER=" + COMPILER,
                        "-DCMAKE_SYSTEM_NAME=Linux", "-DCMAKE_SYSTEM_PROCESSOR=aarch64")
        with open(os.path.join(build, "CMakeFiles", "cores.dir", "flags.make")) as stream:
            flags = stream.read()
        self.assertIn("-Wextra", flags)  # the settings of all packages
        self.assertEqual(re.findall(r"-m(?:arch|cpu|tune|avx|sse|fma)\S*", flags), [])
        self.assertRuns("cmake", "--build", build, "--parallel", str(os.cpu_count()))
        objects = glob.glob(os.path.join(build, "**", "*.cpp.o"), recursive=True)
        self.assertEqual(len(objects), len(sources))
        for path in objects:
            with open(path, "rb") as stream:
                self.assertEqual(stream.read(20)[18:], ELF_AARCH64, path)
