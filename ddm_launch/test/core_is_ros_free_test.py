# The core libraries know nothing of ROS: neither what they include nor what they link.
# SPDX-License-Identifier: BSD-3-Clause
import os
import re
import subprocess
import unittest

import rospkg

# library -> folders with its sources and headers: a package, and where in it
CORES = {"ddm_sim": ("ddm_sim", "include", "src"), "ddm_model": ("ddm_model", "include", "src"),
         "ddm_mpc": ("ddm_mpc", "include", "src"), "ddm_robot": ("ddm_sim", "robot/include", "robot/src")}
# These may be left out of a build.
OPTIONAL = {"ddm_mujoco": ("ddm_sim", "mujoco/include", "mujoco/src")}
ROS_INCLUDE = re.compile(
    r'^\s*#\s*include\s*[<"]((?:ros|xmlrpcpp|\w+_msgs|actionlib|cv_bridge|image_transport'
    r'|diagnostic_updater|nodelet|pluginlib|class_loader|tf2?(?:_ros)?|ros\w+|ddm_bag_io'
    r'|ddm_plant_plugin)/[^>"]+)', re.MULTILINE)
ROS_LIBRARY = re.compile(
    r"^\s*(lib(?:ros\w*|xmlrpcpp|cpp_common|message_filters|actionlib|cv_bridge|image_transport|ddm_images"
    r"|ddm_node|ddm_bag_io|ddm_plant_plugin|class_loader)\.so\S*)", re.MULTILINE)


def sourceFiles(library):
    """Sources and headers of a core library."""
    package = rospkg.RosPack().get_path(CORES[library][0])
    files = []
    for part in CORES[library][1:]:
        for folder, _, names in os.walk(os.path.join(package, part)):
            files += [os.path.join(folder, name) for name in names if name.endswith((".h", ".cpp"))]
    return sorted(files)


def libraryPath(name):
    """The library in the workspace that this test was built in."""
    folders = [os.path.join(prefix, "lib") for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(":") if prefix]
    folders += os.environ.get("LD_LIBRARY_PATH", "").split(":")
    for folder in folders:
        path = os.path.join(folder, "lib%s.so" % name)
        if os.path.isfile(path):
            return path
    raise AssertionError("lib%s.so is in none of %s: build it first" % (name, folders))


for name, places in OPTIONAL.items():
    try:
        libraryPath(name)
    except AssertionError:
        continue
    CORES[name] = places


class CoreIsRosFreeTest(unittest.TestCase):
    def test_cores_include_no_header_of_ros(self):
        """Of ddm_common, the cores use only the header that needs no library."""
        for library in CORES:
            files = sourceFiles(library)
            self.assertGreater(len(files), 1, library)
            for path in files:
                with open(path) as stream:
                    text = stream.read()
                self.assertEqual(ROS_INCLUDE.findall(text), [], path)
                used = re.findall(r'#include [<"](ddm_common/[^>"]+)', text)
                self.assertLessEqual(set(used), {"ddm_common/option_checks.h"}, path)

    def test_cores_link_no_library_of_ros(self):
        for name in ["ddm_common", *CORES]:
            # what the loader says: all libraries that it needs, directly or not
            libraries = subprocess.run(["ldd", libraryPath(name)], check=True, stdout=subprocess.PIPE,
                                       universal_newlines=True).stdout
            self.assertIn("libstdc++", libraries)
            self.assertNotIn("not found", libraries)
            self.assertEqual(ROS_LIBRARY.findall(libraries), [], name)

    def test_functions_of_eigen_are_not_exported_to_libraries_that_were_compiled_otherwise(self):
        for name in CORES:
            exported = subprocess.run(["nm", "--dynamic", "--defined-only", libraryPath(name)], check=True,
                                      stdout=subprocess.PIPE, universal_newlines=True).stdout
            self.assertIn("3ddm", exported, name)
            self.assertEqual(re.findall(r" (_ZN?K?5Eigen\S+)", exported), [], name)
