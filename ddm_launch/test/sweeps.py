# Runs sweeps as a user would, and looks at what they do and leave behind.
# SPDX-License-Identifier: BSD-3-Clause
import os
import signal
import time

from processes import Process, find_program, line_by_line
from run_files import files_in, read_bytes


class Sweep(Process):
    """`rosrun ddm_launch sweep`, in a process group of its own."""

    def __init__(self, *arguments, environment=None, **kwargs):
        command = ["/usr/bin/setsid", find_program("sweep")] + list(arguments)
        super().__init__(command, dict(line_by_line(), **(environment or {})), **kwargs)

    def kill_group(self):
        """Ends it and all in its group without a chance to tidy up."""
        os.killpg(self._process.pid, signal.SIGKILL)
        self.waitForEnd(10.0)


def sweep(*arguments, limit_s=90.0, **kwargs):
    """Runs a sweep to its end. Returns (exit code, output)."""
    process = Sweep(*arguments, **kwargs)
    return process.waitForEnd(limit_s), process.output


def wait_for(condition, what, limit_s=30.0):
    """Returns the condition's value as soon as it is true; fails after the limit."""
    end = time.monotonic() + limit_s
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError("%s did not come within %g s" % (what, limit_s))
        time.sleep(0.005)


def processes_with(words):
    """{pid: words of the command line} of the running processes whose command line holds all of these texts."""
    found = {}
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            command = read_bytes("/proc", pid, "cmdline").decode(errors="replace").split("\0")
        except OSError:  # it ended meanwhile
            continue
        if int(pid) != os.getpid() and all(word in " ".join(command) for word in words):
            found[int(pid)] = command
    return found  # what has ended and waits for its parent has an empty command line


def programs_of(seed_folder):
    """Numbers of the processes that compute a seed."""
    return [pid for pid, command in processes_with([seed_folder]).items()
            if command[0].endswith("/run_experiment") and seed_folder in command]


def snapshot(folder):
    """{name: (time of the last change, content)} of all files in a folder."""
    return {name: (os.stat(os.path.join(folder, name)).st_mtime_ns, read_bytes(folder, name))
            for name in files_in(folder)}


def seed_folder(out, seed):
    return os.path.join(out, "seed_%04d" % seed)


def is_finished(out, seed):
    return os.path.exists(os.path.join(seed_folder(out, seed), "summary.yaml"))
