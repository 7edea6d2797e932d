# Linters find nothing: shellcheck, pyflakes, and clang-tidy where there is time for it.
# SPDX-License-Identifier: BSD-3-Clause
from concurrent.futures import ThreadPoolExecutor
import os
import shutil
import subprocess

import pytest

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
CORES = ["ddm_sim", "ddm_model", "ddm_mpc"]
INCLUDES = ["-I%s/include" % folder for folder in CORES + ["ddm_msgs/common"]] + [
    "-isystem/usr/include/eigen3"]
# clang-tidy takes about ten seconds for a file: these, and those of the last commit, at most so many.
ALGORITHM, MOST_TIDIED = ("objective.cpp", "trainer.cpp", "planner.cpp", "controller.cpp"), 12


def needs(program, version):
    """Those of Debian 12 judge: others find other things."""
    found = shutil.which(program) and output_of(program, "--version").stdout
    return pytest.mark.skipif(not found or version not in found, reason="%s %s is not installed" % (program, version))


def output_of(*command):
    return subprocess.run(command, cwd=CHECKOUT, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          universal_newlines=True)


def scripts(interpreter, suffix):
    """All files below the checkout that an interpreter runs, told by suffix or first line."""
    found = []
    for folder, folders, names in os.walk(CHECKOUT):
        folders[:] = [name for name in folders if name not in (".git", "__pycache__", "results")]
        for path in (os.path.join(folder, name) for name in names):
            with open(path, "rb") as stream:
                first = stream.readline(80)
            if path.endswith(suffix) or first.startswith(b"#!") and interpreter in first:
                found.append(path)
    return found


@needs("shellcheck", "0.9")
def test_shellcheck_finds_nothing():
    files = scripts(b"bash", ".sh")
    assert os.path.join(CHECKOUT, ".ci", "run") in files
    done = output_of("shellcheck", *files)
    assert done.returncode == 0, done.stdout


@needs("flake8", "")
def test_pyflakes_finds_nothing():
    files = scripts(b"python3", ".py")
    assert os.path.realpath(__file__) in files
    done = output_of("flake8", "--isolated", "--select=F", *files)
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
