# Rules for all source files and manifests, and linters without findings: clang-format, catkin_lint, shellcheck, pyflakes, clang-tidy.
# SPDX-License-Identifier: BSD-3-Clause
from concurrent.futures import ThreadPoolExecutor
import glob
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree

import pytest
import yaml

from rooms import CHECKOUT, PACKAGE

FILES = [path for path in glob.glob(os.path.join(CHECKOUT, "**"), recursive=True)
         if os.path.isfile(path) and "__pycache__" not in path] + [os.path.join(CHECKOUT, ".ci", "run")]
CPP_FILES = [path for path in FILES if path.endswith((".h", ".cpp"))]


def read(path):
    with open(path, encoding="utf-8", errors="replace") as stream:
        return stream.read()


def scripts(interpreter, suffix):
    """All files for an interpreter, recognised by suffix or first line."""
    return [path for path in FILES if path.endswith(suffix) or
            "." not in os.path.basename(path) and re.match("#!.*" + interpreter, read(path))]


BASH_FILES, PYTHON_FILES = scripts("bash", ".sh"), scripts("python3", ".py")
CORES = ["ddm_sim", "ddm_model", "ddm_mpc"]
INCLUDES = ["-I%s/include" % folder for folder in CORES + ["ddm_msgs/common"]] + ["-isystem/usr/include/eigen3"]
# clang-tidy takes about ten seconds per file. It checks the files of ALGORITHM and those of the last commit, at most
# MOST_TIDIED files.
ALGORITHM, MOST_TIDIED = ("objective.cpp", "trainer.cpp", "planner.cpp", "controller.cpp"), 12
# Functions that could execute text of a file or message.
UNSAFE_PYTHON = re.compile(r"\b(eval|exec|execvp)\(|\bpickle\b|\bos\.(system|popen)\b|shell=True|allow_pickle=True|"
                           r"yaml\.(unsafe_|full_)?load(_all)?\((?!.*Loader=(LOADER|yaml\.BaseLoader)\))")
UNSAFE_CPP = re.compile(r"\b(system|popen|dlopen|exec[lv]p?e?)\(")
MAY_EXECUTE = ("ddm_study/pages.py", "ddm_study/study.py")  # these execute text of the pages, and make


def output_of(*command):
    return subprocess.run(command, cwd=CHECKOUT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True)


def needs(program, version=""):
    """Skips a test unless the linter of Debian 12 is installed, because other versions have other findings."""
    found = shutil.which(program) and output_of(program, "--version").stdout
    return pytest.mark.skipif(not found or version not in found, reason="%s %s is not installed" % (program, version))


@pytest.mark.parametrize("command, files", [
    pytest.param(["clang-format", "--dry-run", "-Werror"], CPP_FILES, marks=needs("clang-format", " 14.")),
    pytest.param(["shellcheck"], BASH_FILES, marks=needs("shellcheck", "0.9")),
    pytest.param(["flake8", "--isolated", "--select=F"], PYTHON_FILES, marks=needs("flake8")),
    pytest.param(["env", "ROS_HOME=/nonexistent", "catkin_lint", "--strict", "--offline"],  # without a rosdep database
                 [os.path.dirname(path) for path in FILES if path.endswith("/package.xml")], marks=needs("catkin_lint"))])
def test_linters_find_nothing(command, files):
    assert files
    done = output_of(*command, *files)
    assert done.returncode == 0, done.stdout


@needs("clang-tidy", "version 14.")
def test_clang_tidy_finds_nothing_in_the_algorithm_and_in_core_sources_of_the_last_commit():
    changed = output_of("git", "diff", "--name-only", "HEAD~1").stdout.split()
    paths = ["%s/src/%s" % (core, name) for core in CORES for name in sorted(os.listdir(os.path.join(CHECKOUT, core, "src")))
             if name in ALGORITHM or name.endswith(".cpp") and "%s/src/%s" % (core, name) in changed][:MOST_TIDIED]
    assert len(paths) >= len(ALGORITHM)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = pool.map(lambda path: output_of("clang-tidy", "--quiet", "--warnings-as-errors=*", path, "--", "-std=c++17",
                                                  "-fopenmp", *INCLUDES), paths)
        assert "".join(done.stdout for done in results if done.returncode != 0) == ""


def test_each_source_file_says_what_it_is_and_has_a_licence_line():
    for path in CPP_FILES + BASH_FILES + PYTHON_FILES:
        lines = [line for line in read(path).split("\n")[:3] if not line.startswith("#!")]
        assert len(lines[0]) >= 12 and lines[1].lstrip("#/ ") == "SPDX-License-Identifier: BSD-3-Clause", path


def test_programs_execute_nothing_that_a_file_or_message_says():
    for path in CPP_FILES + PYTHON_FILES:
        if not re.search("/test/|/testing/", path) and not path.endswith(MAY_EXECUTE):
            assert not (UNSAFE_CPP if path in CPP_FILES else UNSAFE_PYTHON).search(read(path)), path


def test_no_file_names_a_folder_of_a_machine():
    for path in [path for path in FILES if path.endswith((".h", ".cpp", ".sh", ".py", ".md", ".yaml", ".csv"))]:
        assert not re.search(r"(?<![\w.~}$])/(root/dev|work)/\w", read(path)), path


def tags(end):
    """Texts of all tags in the manifests of packages whose names end with `end`."""
    return {element.text.strip() for path in FILES if path.endswith("/package.xml")
            for element in xml.etree.ElementTree.parse(path).getroot() if element.tag.endswith(end)}


def test_rosdep_finds_every_dependency_on_debian_with_noetic_and_with_ros_o():
    known = yaml.safe_load(read(os.path.join(PACKAGE, "test", "rosdep_keys.yaml")))
    keys, used = set(known["system"]).union(*known["ros"].values()), tags("depend") - tags("name")
    assert len(used) > 40
    assert used == keys, "rosdep has no such key, rosdep_keys.yaml lacks it, or no package.xml names it any more"
    # Some systems do not have these packages, so they must not be dependencies.
    assert not [key for key in used if "mujoco" in key or "egl" in key]
