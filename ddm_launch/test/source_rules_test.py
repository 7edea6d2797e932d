# Rules that every source file keeps: formatting, package manifests, script syntax, licence line.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

import yaml

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
PACKAGES = sorted(os.path.dirname(path) for pattern in ("*", "examples/*")
                  for path in glob.glob(os.path.join(CHECKOUT, pattern, "package.xml")))


def clang_format_version():
    """None where there is none."""
    if not shutil.which("clang-format"):
        return None
    text = subprocess.run(["clang-format", "--version"], stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout
    return int(re.search(r"version (\d+)", text).group(1))


CLANG_FORMAT = clang_format_version()
LICENCE_TAG = "SPDX-License-Identifier: BSD-3-Clause"


def first_lines(path, count):
    with open(path, errors="replace") as stream:
        return [line for _, line in zip(range(count), stream)]


def source_files():
    """All files of our packages, and the CI script."""
    files = [os.path.join(CHECKOUT, ".ci", "run")]
    for package in PACKAGES:
        for folder, folders, names in os.walk(package):
            folders[:] = [name for name in folders if name != "__pycache__"]
            files += [os.path.join(folder, name) for name in names]
    return sorted(files)


def scripts(interpreter):
    """Source files that this interpreter runs, told by suffix or first line."""
    suffix = {"python3": ".py", "bash": ".sh"}[interpreter]
    return [path for path in source_files() if path.endswith(suffix) or (
        "." not in os.path.basename(path)
        and "".join(first_lines(path, 1)).startswith("#!") and interpreter in first_lines(path, 1)[0])]


# What could execute something from a file or a message.
UNSAFE_PYTHON = re.compile(r"\b(eval|exec)\(|\bpickle\b|\bos\.(system|popen)\b|shell=True|allow_pickle=True|"
                           r"yaml\.(unsafe_|full_)?load(_all)?\((?!.*Loader=(LOADER|yaml\.BaseLoader)\))")
UNSAFE_CPP = re.compile(r"\b(system|popen|dlopen|exec[lv]p?e?)\(")

CPP_FILES = [path for path in source_files() if path.endswith((".h", ".cpp"))]


class SourceRulesTest(unittest.TestCase):
    maxDiff = None

    def assertRuns(self, *command):
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)
        self.assertEqual(done.returncode, 0, "%s\n%s" % (" ".join(command[:4]), done.stdout))

    def test_all_packages_and_kinds_of_files_are_seen(self):
        names = [os.path.basename(package) for package in PACKAGES]
        self.assertTrue({"ddm_msgs", "ddm_sim", "ddm_launch", "ddm_cart"} <= set(names), names)
        self.assertGreater(len(CPP_FILES), 10)
        self.assertIn(os.path.realpath(__file__), scripts("python3"))
        self.assertIn(os.path.join(CHECKOUT, ".ci", "run"), scripts("bash"))

    @unittest.skipUnless(CLANG_FORMAT == 14, "clang-format 14 judges, and this is %s: others break lines elsewhere" % CLANG_FORMAT)
    def test_cpp_files_are_formatted_by_clang_format(self):
        self.assertRuns("clang-format", "--dry-run", "-Werror", *CPP_FILES)

    def test_a_commit_is_formatted_by_clang_format_14_or_refused(self):
        with open(os.path.join(CHECKOUT, ".pre-commit-config.yaml")) as stream:
            hook = yaml.safe_load(stream)["repos"][0]["hooks"][0]
        for versions, formats in (({"clang-format": 14}, "clang-format"), ({"clang-format": 19}, None), ({}, None),
                                  ({"clang-format": 19, "clang-format-14": 14}, "clang-format-14")):
            with tempfile.TemporaryDirectory() as folder:
                for name, version in versions.items():
                    path = os.path.join(folder, name)
                    with open(path, "w") as stream:
                        stream.write("#!/bin/sh\n[ $1 = -i ] && echo formatted by %s $2\necho version %d.0.6\n" % (name, version))
                    os.chmod(path, 0o755)
                for name in ("bash", "sh", "grep"):
                    os.symlink(shutil.which(name), os.path.join(folder, name))
                done = subprocess.run(shlex.split(hook["entry"]) + ["a.cpp"], env={"PATH": folder}, stdout=subprocess.PIPE,
                                      universal_newlines=True)
            self.assertEqual(done.returncode == 0, formats is not None)
            self.assertIn("formatted by %s a.cpp" % formats if formats else "apt-get install clang-format-14", done.stdout)

    @unittest.skipUnless(shutil.which("catkin_lint"), "catkin_lint is not installed")
    def test_catkin_lint_finds_nothing(self):
        with tempfile.TemporaryDirectory() as no_rosdep:  # the verdict must not depend on a rosdep database
            self.assertRuns("env", "ROS_HOME=" + no_rosdep, "catkin_lint", "--strict", "--offline", *PACKAGES)

    def test_shell_scripts_parse(self):
        for path in scripts("bash"):
            self.assertRuns("bash", "-n", path)

    def test_python_scripts_parse(self):
        for path in scripts("python3"):
            with open(path) as stream:
                compile(stream.read(), path, "exec")

    def test_python_scripts_name_the_interpreter_that_has_ros(self):
        wrong = [path for path in scripts("python3") if os.access(path, os.X_OK)
                 and first_lines(path, 1) != ["#!/usr/bin/python3\n"]]
        self.assertEqual(wrong, [])

    def test_each_source_file_has_a_first_line_that_says_what_it_is_and_a_licence_line(self):
        wrong = []
        for path in CPP_FILES + scripts("python3") + scripts("bash"):
            lines = [line for line in first_lines(path, 3) if not line.startswith("#!")]
            if len(lines) < 2 or len(lines[0]) < 12 or lines[1].lstrip("#/ ").strip() != LICENCE_TAG:
                wrong.append(os.path.relpath(path, CHECKOUT))
        self.assertEqual(wrong, [])

    def test_programs_execute_nothing_that_a_file_or_message_says(self):
        self.assertTrue(UNSAFE_PYTHON.search("tree = yaml.load(stream)"))
        self.assertTrue(UNSAFE_CPP.search("  std::system(command.c_str());"))
        wrong = []
        for files, unsafe in ((scripts("python3"), UNSAFE_PYTHON), (CPP_FILES, UNSAFE_CPP)):
            for path in files:
                if "/test/" not in path and "/testing/" not in path:
                    with open(path) as stream:
                        wrong += ["%s: %s" % (os.path.relpath(path, CHECKOUT), line.strip())
                                  for line in stream if unsafe.search(line)]
        self.assertEqual(wrong, [])

    def test_each_argument_of_a_launch_file_has_a_word_for_roslaunch_ros_args(self):
        without = []
        for path in glob.glob(os.path.join(CHECKOUT, "*", "**", "launch", "*.launch"), recursive=True):
            for argument in xml.etree.ElementTree.parse(path).getroot().findall("arg"):
                if argument.get("value") is None and not argument.get("doc"):
                    without.append((os.path.basename(path), argument.get("name")))
        self.assertEqual(without, [])

    @unittest.skipUnless(shutil.which("wstool"), "Debian 13 has no wstool")
    def test_wstool_accepts_the_rosinstall_file(self):
        self.assertRuns("wstool", "info", "-t", CHECKOUT)
