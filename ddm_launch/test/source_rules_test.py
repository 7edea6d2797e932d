# Rules that every source file keeps: formatting, package manifests, the first two lines, no path of a machine.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os
import re
import shutil
import subprocess

import pytest

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
FILES = [path for path in glob.glob(os.path.join(CHECKOUT, "**"), recursive=True)
         if os.path.isfile(path) and "__pycache__" not in path]
CPP_FILES = [path for path in FILES if path.endswith((".h", ".cpp"))]
SCRIPTS = [path for path in FILES if path.endswith((".py", ".sh")) or
           "/scripts/" in path and "." not in os.path.basename(path)]
# What could execute something from a file or a message.
UNSAFE_PYTHON = re.compile(r"\b(eval|exec|execvp)\(|\bpickle\b|\bos\.(system|popen)\b|shell=True|allow_pickle=True|"
                           r"yaml\.(unsafe_|full_)?load(_all)?\((?!.*Loader=(LOADER|yaml\.BaseLoader)\))")
UNSAFE_CPP = re.compile(r"\b(system|popen|dlopen|exec[lv]p?e?)\(")
MAY_EXECUTE = ("ddm_study/pages.py", "ddm_study/program.py")  # text of our pages; make


def read(path):
    with open(path, encoding="utf-8", errors="replace") as stream:
        return stream.read()


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    assert done.returncode == 0, done.stdout


def test_cpp_files_are_formatted():
    program = next(filter(shutil.which, ("clang-format-14", "clang-format")), None)
    if not program or " 14." not in subprocess.check_output([program, "--version"], universal_newlines=True):
        pytest.skip("clang-format 14 is not installed: other versions break lines elsewhere")
    run(program, "--dry-run", "-Werror", *CPP_FILES)


@pytest.mark.skipif(not shutil.which("catkin_lint"), reason="catkin_lint is not installed")
def test_catkin_lint_finds_nothing(tmp_path):
    packages = [os.path.dirname(path) for pattern in ("*", "examples/*")
                for path in glob.glob(os.path.join(CHECKOUT, pattern, "package.xml"))]
    run("env", "ROS_HOME=%s" % tmp_path, "catkin_lint", "--strict", "--offline", *packages)  # without a rosdep database


def test_each_source_file_says_what_it_is_and_has_a_licence_line():
    wrong = []
    for path in CPP_FILES + SCRIPTS:
        lines = [line for line in read(path).split("\n")[:3] if not line.startswith("#!")]
        if len(lines[0]) < 12 or not lines[1].lstrip("#/ ") == "SPDX-License-Identifier: BSD-3-Clause":
            wrong.append(path)
    assert not wrong


def test_no_file_names_a_folder_of_a_machine():
    texts = [path for path in FILES if path.endswith((".md", ".yaml", ".csv"))]
    assert not [path for path in CPP_FILES + SCRIPTS + texts if re.search(r"(?<![\w.~}$])/(root/dev|work)/\w", read(path))]


def test_programs_execute_nothing_that_a_file_or_message_says():
    wrong = [path for path in CPP_FILES + SCRIPTS if not re.search("/test/|/testing/", path)
             and not path.endswith(MAY_EXECUTE)
             and any((UNSAFE_CPP if path in CPP_FILES else UNSAFE_PYTHON).search(line) for line in read(path).split("\n"))]
    assert not wrong
