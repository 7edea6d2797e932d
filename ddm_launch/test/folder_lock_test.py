# Folders that one process at a time writes into: sweeps in Python, experiments in C++.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import subprocess

from ddm_launch.command import Failure
from ddm_launch.folder_lock import FolderLock, text_of, this_process
from processes import Process, find_program, run_experiment
from run_files import expected_files, files_in, read_bytes
from scratch_case import ScratchCase
from sweeps import seed_folder, sweep, wait_for

# A file system without locks of the kernel, as on some clusters.
NO_LOCKS = """
#include <errno.h>
#include <fcntl.h>
int flock(int file, int operation) { errno = ENOLCK; return -1; }
int lockf(int file, int command, off_t size) { errno = ENOLCK; return -1; }
"""


class FolderLockTest(ScratchCase):
    def setUp(self):
        super().setUp()
        os.mkdir(self.out)

    def assertIsHeld(self, *words):
        with self.assertRaises(Failure) as caught:
            FolderLock(self.out)
        for word in (self.out,) + words:
            self.assertIn(word, str(caught.exception))

    def leaveLock(self, **values):
        self.write(os.path.join(self.out, ".lock"), text_of(dict(this_process(), **values)))

    def startExperiment(self):
        process = Process([find_program("run_experiment"), "--preset", "debug", "--trials", 999, "--out", self.out])
        self.addCleanup(process.stop)
        wait_for(lambda: "trial_001/model.ddm" in files_in(self.out), "the first training")
        return process

    def test_a_held_folder_is_refused_and_a_free_one_has_no_files(self):
        lock = FolderLock(self.out)
        self.assertIsHeld("process %d on this machine" % os.getpid())
        code, output = run_experiment("--preset", "debug", "--trials", 0, "--out", self.out)
        self.assertEqual(code, 1, output)
        self.assertIn("process %d on this machine" % os.getpid(), output)
        lock.release()
        self.assertEqual(files_in(self.out), [])

    def test_the_lock_of_a_killed_experiment_and_its_half_files_do_not_stay(self):
        process = self.startExperiment()
        self.assertIsHeld("on this machine")
        process.send(signal.SIGKILL)
        process.waitForEnd(10.0)
        self.assertIn(".lock", files_in(self.out))
        self.write(os.path.join(self.out, "trial_000", "model.ddm.unfinished.0f"), "half")
        FolderLock(self.out).release()
        trials = len(read_bytes(self.out, "trials.csv").splitlines())
        code, output = run_experiment("--preset", "debug", "--trials", trials, "--out", self.out)
        self.assertEqual(code, 0, output)
        self.assertEqual([name for name in files_in(self.out) if "unfinished" in name or name.startswith(".lock")], [])

    def test_an_experiment_that_a_signal_ends_frees_its_folder(self):
        process = self.startExperiment()
        process.send(signal.SIGTERM)
        self.assertEqual(process.waitForEnd(10.0), -signal.SIGTERM)
        self.assertNotIn(".lock", files_in(self.out))

    def test_only_the_lock_of_a_process_that_has_certainly_ended_is_replaced(self):
        for ended in ({"start": "1"}, {"boot": "another"}):
            self.leaveLock(**ended)
            FolderLock(self.out).release()
        for other in ({"host": "node17"}, {"machine": "of the same name"}, {"namespace": "of a container"}):
            self.leaveLock(**other)
            self.assertIsHeld("sure", "delete %s/.lock" % self.out)
        for text in ("", "garbage", "host: a\npid: 1\n"):
            self.write(os.path.join(self.out, ".lock"), text)
            self.assertIsHeld("delete %s/.lock" % self.out)
        self.assertEqual(files_in(self.out), [".lock"])

    def test_a_file_system_without_locks_of_the_kernel_will_do(self):
        library = self.file("no_locks.so")
        source = self.write("no_locks.c", NO_LOCKS)
        subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)
        code, output = sweep("--preset", "debug", "--seeds", "0:1", "--trials", 0, "--out", self.out,
                             environment={"LD_PRELOAD": library})
        self.assertEqual(code, 0, output)
        self.assertEqual(files_in(seed_folder(self.out, 0)), expected_files(0))
