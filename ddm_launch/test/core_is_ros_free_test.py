# The core libraries neither include nor link anything of ROS.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import subprocess

import pytest

from rooms import CHECKOUT

# The folder with include/ and src/ of each library. A build may omit the last library.
CORES = {"ddm_sim": "ddm_sim", "ddm_model": "ddm_model", "ddm_mpc": "ddm_mpc", "ddm_robot": "ddm_sim/robot",
         "ddm_mujoco": "ddm_sim/mujoco"}
ROS_INCLUDE = re.compile(
    r'^\s*#\s*include\s*[<"]((?:ros|xmlrpcpp|\w+_msgs|actionlib|cv_bridge|image_transport'
    r'|diagnostic_updater|nodelet|pluginlib|class_loader|tf2?(?:_ros)?|ros\w+|ddm_bag_io'
    r'|ddm_plant_plugin)/[^>"]+)', re.MULTILINE)
ROS_LIBRARY = re.compile(
    r"^\s*(lib(?:ros\w*|xmlrpcpp|cpp_common|message_filters|actionlib|cv_bridge|image_transport|ddm_images"
    r"|ddm_node|ddm_bag_io|ddm_plant_plugin|class_loader)\.so\S*)", re.MULTILINE)


def output_of(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout


@pytest.mark.parametrize("library", ["ddm_common", *CORES])
def test_a_core_includes_and_links_nothing_of_ros_and_exports_no_functions_of_eigen(library):
    path = next((path for path in (os.path.join(prefix, "lib", "lib%s.so" % library)
                                   for prefix in os.environ["CMAKE_PREFIX_PATH"].split(":")) if os.path.isfile(path)), None)
    if path is None and library == "ddm_mujoco":
        pytest.skip("the build is without this library")
    needed = output_of("ldd", path)  # ldd lists all direct and indirect dependencies
    assert "libstdc++" in needed and "not found" not in needed
    assert ROS_LIBRARY.findall(needed) == []
    if library == "ddm_common":
        return
    files = [path for part in ("include", "src") for path in glob.glob(
        os.path.join(CHECKOUT, CORES[library], part, "**", "*.*"), recursive=True) if path.endswith((".h", ".cpp"))]
    assert len(files) > 1
    for source in files:
        with open(source) as stream:
            text = stream.read()
        assert ROS_INCLUDE.findall(text) == [], source
        used = set(re.findall(r'#include [<"]ddm_common/([^>"]+)', text))
        assert used <= {"option_checks.h", "random_stream.h"}, source  # these headers need no library
    # The library must not export functions of Eigen, because libraries with other compiler settings would call them.
    exported = output_of("nm", "--dynamic", "--defined-only", path)
    assert "3ddm" in exported and re.findall(r" (_ZN?K?5Eigen\S+)", exported) == []
