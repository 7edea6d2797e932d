# Engine of a sweep: GNU parallel, on this machine or over ssh.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import shlex
import shutil
import signal
import subprocess

from ddm_launch.command import Failure
from ddm_launch.seed_script import DIE_WITH_PARENT

POLL_S = 0.5


class GnuParallel:
    """Runs the seeds of a sweep, `jobs` at a time on each host."""

    def __init__(self, jobs, hosts, terminal):
        """jobs: None for one per core. hosts: file of ssh hosts, None for this machine. terminal: show a bar.

        Raises Failure if GNU parallel is not installed.
        """
        self.jobs, self.hosts, self.terminal = jobs, hosts, terminal
        if shutil.which("parallel") is None:
            raise Failure("the program parallel is not installed: apt-get install parallel")
        version = subprocess.run(["parallel", "--plain", "--will-cite", "--version"], stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, universal_newlines=True).stdout
        if not version.startswith("GNU parallel"):  # moreutils has another program of this name
            raise Failure("%s is not GNU parallel: apt-get install parallel" % shutil.which("parallel"))

    def _command(self, folder):
        words = DIE_WITH_PARENT + ["parallel", "--plain", "--will-cite", "--joblog", folder.joblog]
        if self.jobs is not None:
            words += ["--jobs", str(self.jobs)]
        if self.hosts is not None:
            words += ["--sshloginfile", os.path.abspath(self.hosts), "--filter-hosts"]
        if self.terminal:
            words += ["--bar"]
        return words + [" ".join(DIE_WITH_PARENT + ["bash", shlex.quote(folder.script), "{}"])]

    def run(self, folder, seeds, tick):
        """Returns when all seeds have ended, well or not. Calls tick() now and then.

        An exception out of tick(), or out of a signal handler, ends all seeds first.
        """
        environment = dict(os.environ, PARALLEL_SHELL="/bin/bash",
                           PARALLEL_SSH=" ".join(DIE_WITH_PARENT + [os.environ.get("PARALLEL_SSH", "ssh")]))
        process = subprocess.Popen(self._command(folder) + [":::"] + [str(seed) for seed in seeds],
                                   stdin=subprocess.DEVNULL, env=environment)
        try:
            while process.poll() is None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(POLL_S)
                tick()
        except BaseException:
            process.send_signal(signal.SIGINT)  # of all signals the one that makes every version end its jobs
            process.wait()
            raise
