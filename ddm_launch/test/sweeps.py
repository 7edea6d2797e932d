# Runs sweeps as a user would, and inspects their processes and files.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import time

from processes import Process, find_program, line_by_line
from run_files import files_in, read_bytes


class Sweep(Process):
    """`rosrun ddm_launch sweep` in a process group of its own."""

    def __init__(self, *arguments, environment=None, **kwargs):
        command = ["/usr/bin/setsid", find_program("sweep")] + list(arguments)
        super().__init__(command, dict(line_by_line(), **(environment or {})), **kwargs)

    def kill_group(self):
        """Kills the sweep and its process group without a chance to clean up."""
        os.killpg(self.pid, signal.SIGKILL)
        self.waitForEnd(10.0)


def debug(out, seeds="0:4", trials=1):
    """Arguments of a sweep that takes seconds."""
    return ["--preset", "debug", "--seeds", seeds, "--trials", trials, "--out", out]


def assert_ends(code, words, *arguments, **kwargs):
    """Runs a sweep to its end and checks its exit code and words in its output. Returns the output."""
    process = Sweep(*arguments, **kwargs)
    assert process.waitForEnd(90.0) == code, process.output
    assert all(word in process.output for word in words), process.output
    return process.output


def assert_table(out, seeds, trials=1):
    """sweep.csv has one header, then exactly the rows of these seeds."""
    expected = [read_bytes(seed_folder(out, seed), "trials.csv").splitlines() for seed in seeds]
    lines = read_bytes(out, "sweep.csv").splitlines()
    assert lines == expected[0][:1] + [row for table in expected for row in table[1:trials + 2]]
    assert [line.split(b",")[:2] for line in lines[1:]] == [[b"%d" % seed, b"%d" % k] for seed in seeds for k in range(trials + 1)]


def wait_for(condition, what, limit_s=30.0):
    """Returns the value of condition() as soon as it is true; fails after the time limit."""
    end = time.monotonic() + limit_s
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError("%s did not come within %g s" % (what, limit_s))
        time.sleep(0.005)


def processes_with(words):
    """{process id: words of the command line} of the running processes whose command line contains all of these
    texts."""
    found = {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = read_bytes("/proc", pid, "cmdline").decode(errors="replace").split("\0")
        except OSError:  # the process has ended meanwhile
            continue
        if int(pid) != os.getpid() and all(word in " ".join(command) for word in words):
            found[int(pid)] = command
    return found  # the command line of a zombie process is empty


def assert_nothing_runs(out):
    """Checks that all processes that name the folder end within the limit."""
    wait_for(lambda: not processes_with([out]), "the end of all processes", 10.0)


def programs_of(folder):
    """Process ids of the programs that compute a seed."""
    return [pid for pid, command in processes_with([folder]).items()
            if command[0].endswith("/run_experiment") and folder in command]


def snapshot(folder):
    """Returns {name: (modification time, content)} of all files in a folder."""
    return {name: (os.stat(os.path.join(folder, name)).st_mtime_ns, read_bytes(folder, name))
            for name in files_in(folder)}


def seed_folder(out, seed):
    return os.path.join(out, "seed_%04d" % seed)


def is_finished(out, seed):
    return os.path.exists(os.path.join(seed_folder(out, seed), "summary.yaml"))
