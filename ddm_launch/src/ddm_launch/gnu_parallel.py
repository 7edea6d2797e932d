# Runs the seeds of a sweep with GNU parallel, on this machine or over ssh.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import shlex
import signal
import subprocess

from ddm_launch.command import Failure
from ddm_launch.slurm import job_file, remembered
from ddm_launch.sweep_folder import DIE_WITH_PARENT

POLL_S = 0.5


class GnuParallel:
    """Runs the seeds of a sweep, with `jobs` seeds at a time on each host."""

    def __init__(self, jobs, hosts):
        """jobs: seeds at a time; None: one per core. hosts: file of ssh hosts; None: this machine. Raises Failure if
        GNU parallel is not installed."""
        self.options = ["--jobs", str(jobs)] if jobs is not None else []
        if hosts is not None:
            self.options += ["--sshloginfile", os.path.abspath(hosts), "--filter-hosts"]
        try:
            version = subprocess.check_output(["parallel", "--plain", "--will-cite", "--version"], stdin=subprocess.DEVNULL,
                                              stderr=subprocess.DEVNULL, universal_newlines=True)
        except (FileNotFoundError, subprocess.CalledProcessError):
            version = ""
        if not version.startswith("GNU parallel"):  # the package moreutils has another program named parallel
            raise Failure("the program parallel is not installed, or not GNU parallel: apt-get install parallel")

    def resume(self, folder, _tick):
        """Raises Failure if a Slurm job array of an earlier call may still be running in this folder."""
        job = remembered(folder)
        if job is not None:
            raise Failure("%s. Delete %s if that job has ended" % (job.how_to_go_on(), job_file(folder)))

    def run(self, folder, seeds, tick):
        """Runs the seeds and returns when all have ended, whether they succeed or fail. Calls tick() every POLL_S
        seconds.

        If tick() or a signal handler raises an exception, the method ends all seeds and raises the exception again.
        """
        command = DIE_WITH_PARENT + ["parallel", "--plain", "--will-cite", "--joblog", folder.joblog] + self.options
        command += [" ".join(DIE_WITH_PARENT + ["bash", shlex.quote(folder.script), "{}"]), ":::"] + [str(seed) for seed in seeds]
        environment = dict(os.environ, PARALLEL_SHELL="/bin/bash",
                           PARALLEL_SSH=" ".join(DIE_WITH_PARENT + [os.environ.get("PARALLEL_SSH", "ssh")]))
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, env=environment)
        try:
            while process.poll() is None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(POLL_S)
                tick()
        except BaseException:
            process.send_signal(signal.SIGINT)  # all versions of GNU parallel end their jobs after this signal
            process.wait()
            raise
