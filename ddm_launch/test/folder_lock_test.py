# Folders that one process at a time writes into: sweeps in Python, experiments in C++.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess

import pytest

from ddm_launch.command import Failure
from ddm_launch.folder_lock import FolderLock, text_of, this_process
from processes import Process, find_program, run_experiment
from run_files import expected_files, files_in, read_bytes
from sweeps import assert_ends, debug, seed_folder, wait_for

# A file system without locks of the kernel, as on some clusters.
NO_LOCKS = """
#include <errno.h>
#include <fcntl.h>
int flock(int file, int operation) { errno = ENOLCK; return -1; }
int lockf(int file, int command, off_t size) { errno = ENOLCK; return -1; }
"""


@pytest.fixture(name="out")
def make_folder(tmp_path):
    (tmp_path / "out").mkdir()
    return str(tmp_path / "out")


def assert_held(out, *words):
    with pytest.raises(Failure) as caught:
        FolderLock(out)
    assert all(word in str(caught.value) for word in (out,) + words), caught.value


def write_lock(out, text):
    with open(os.path.join(out, ".lock"), "w") as stream:
        stream.write(text)


def test_a_held_folder_is_refused_and_a_free_one_has_no_files(out):
    lock = FolderLock(out)
    assert_held(out, "process %d on this machine" % os.getpid())
    code, output = run_experiment("--preset", "debug", "--trials", 0, "--out", out)
    assert code == 1 and "process %d on this machine" % os.getpid() in output, output
    lock.release()
    assert files_in(out) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_the_lock_of_an_experiment_that_was_ended_and_its_half_files_do_not_stay(number, out):
    with Process([find_program("run_experiment"), "--preset", "debug", "--trials", 999, "--out", out]) as process:
        wait_for(lambda: "trial_001/model.ddm" in files_in(out), "the first training")
        assert_held(out, "on this machine")
        process.send(number)
        assert process.waitForEnd(10.0) == -number
    assert (".lock" in files_in(out)) == (number == signal.SIGKILL)
    with open(os.path.join(out, "trial_000", "model.ddm.unfinished.0f"), "w"):
        pass
    FolderLock(out).release()
    trials = len(read_bytes(out, "trials.csv").splitlines())
    code, output = run_experiment("--preset", "debug", "--trials", trials, "--out", out)
    assert code == 0, output
    assert [name for name in files_in(out) if "unfinished" in name or name.startswith(".lock")] == []


def test_only_the_lock_of_a_process_that_has_certainly_ended_is_replaced(out):
    for ended in ({"start": "1"}, {"boot": "another"}):
        write_lock(out, text_of(dict(this_process(), **ended)))
        FolderLock(out).release()
    for other in ({"host": "node17"}, {"machine": "of the same name"}, {"namespace": "of a container"}):
        write_lock(out, text_of(dict(this_process(), **other)))
        assert_held(out, "sure", "delete %s/.lock" % out)
    for text in ("", "garbage", "host: a\npid: 1\n"):
        write_lock(out, text)
        assert_held(out, "delete %s/.lock" % out)
    assert files_in(out) == [".lock"]


def test_a_file_system_without_locks_of_the_kernel_will_do(out, tmp_path):
    (tmp_path / "no_locks.c").write_text(NO_LOCKS)
    library = str(tmp_path / "no_locks.so")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, str(tmp_path / "no_locks.c")], check=True)
    assert_ends(0, [], *debug(out, "0:1", 0), environment={"LD_PRELOAD": library})
    assert files_in(seed_folder(out, 0)) == expected_files(0)
