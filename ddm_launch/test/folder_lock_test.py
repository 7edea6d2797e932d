# Folders that one process at a time writes into: sweeps in Python, experiments in C++.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess

import pytest

from ddm_launch.command import Failure
from ddm_launch.folder_lock import FolderLock, text_of, this_process
from processes import Process, find_program, run_experiment
from run_files import expected_files, files_in
from sweeps import seed_folder, sweep

# A file system without locks of the kernel, as on some clusters.
NO_LOCKS = """
#include <errno.h>
#include <fcntl.h>
int flock(int file, int operation) { errno = ENOLCK; return -1; }
int lockf(int file, int command, off_t size) { errno = ENOLCK; return -1; }
"""


def assert_is_held(folder, *words):
    with pytest.raises(Failure) as caught:
        FolderLock(str(folder))
    for word in (str(folder),) + words:
        assert word in str(caught.value)


def test_a_held_folder_is_refused_and_a_free_one_has_no_files(tmp_path):
    lock = FolderLock(str(tmp_path))
    assert_is_held(tmp_path, "process %d on this machine" % os.getpid())
    code, output = run_experiment("--preset", "debug", "--trials", 0, "--out", tmp_path)
    assert code == 1 and "process %d on this machine" % os.getpid() in output
    lock.release()
    assert files_in(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_the_lock_of_an_experiment_that_was_ended_and_its_half_files_do_not_stay(tmp_path, number):
    with Process([find_program("run_experiment"), "--preset", "debug", "--trials", 999, "--out", tmp_path]) as process:
        process.waitForText("trial  0/999", 120.0)
        assert_is_held(tmp_path, "on this machine")
        process.send(number)
        assert process.waitForEnd(60.0) == -number
    assert (".lock" in files_in(tmp_path)) == (number == signal.SIGKILL)
    (tmp_path / "trial_000" / "model.ddm.unfinished.0f").write_text("half")
    trials = len((tmp_path / "trials.csv").read_text().splitlines())
    code, output = run_experiment("--preset", "debug", "--trials", trials, "--out", tmp_path)
    assert code == 0, output
    assert [name for name in files_in(tmp_path) if "unfinished" in name or name.startswith(".lock")] == []


def test_only_the_lock_of_a_process_that_has_certainly_ended_is_replaced(tmp_path):
    lock = tmp_path / ".lock"
    for ended in ({"start": "1"}, {"boot": "another"}):
        lock.write_text(text_of(dict(this_process(), **ended)))
        FolderLock(str(tmp_path)).release()
    for other in ({"host": "node17"}, {"machine": "of the same name"}, {"namespace": "of a container"}):
        lock.write_text(text_of(dict(this_process(), **other)))
        assert_is_held(tmp_path, "sure", "delete %s" % lock)
    for text in ("", "garbage", "host: a\npid: 1\n"):
        lock.write_text(text)
        assert_is_held(tmp_path, "delete %s" % lock)


def test_a_file_system_without_locks_of_the_kernel_will_do(tmp_path):
    (tmp_path / "no_locks.c").write_text(NO_LOCKS)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", tmp_path / "no_locks.so", tmp_path / "no_locks.c"], check=True)
    code, output = sweep("--preset", "debug", "--seeds", "0:1", "--trials", 0, "--out", str(tmp_path / "out"),
                         environment={"LD_PRELOAD": str(tmp_path / "no_locks.so")})
    assert code == 0, output
    assert files_in(seed_folder(str(tmp_path / "out"), 0)) == expected_files(0)
