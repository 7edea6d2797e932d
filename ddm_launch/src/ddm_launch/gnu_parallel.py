# Runs the seeds of a sweep with GNU parallel, on this machine or over ssh.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import shlex
import signal
import subprocess
import sys

from ddm_launch.command import Failure
from ddm_launch.slurm import how_to_go_on, job_file
from ddm_launch.sweep_folder import DIE_WITH_PARENT

POLL_S = 0.5
ANSWER_S = 20
PARALLEL = DIE_WITH_PARENT + ["parallel", "--plain", "--will-cite"]


def environment_of_parallel():
    """Environment of GNU parallel: its ssh processes end with it."""
    return dict(os.environ, PARALLEL_SHELL="/bin/bash",
                PARALLEL_SSH=" ".join(DIE_WITH_PARENT + [os.environ.get("PARALLEL_SSH", "ssh")]))


def hosts_that_answer(path):
    """The lines of a file of ssh hosts whose hosts answer within ANSWER_S. Names the other hosts on stderr. Raises
    Failure if no host answers. GNU parallel's own --filter-hosts is not used, because it stops with an internal error
    at every host whose login shell prints something."""
    with open(path, errors="replace") as stream:
        hosts = [host for host in (line.split("#")[0].strip() for line in stream) if host]
    print("asking %d hosts whether they answer" % len(hosts), flush=True)
    checks = [subprocess.Popen(PARALLEL + ["--sshlogin", host, "--jobs", "1", "--timeout", str(ANSWER_S), "true", ":::", ""],
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               env=environment_of_parallel()) for host in hosts]
    answers = [host for host, check in zip(hosts, checks) if check.wait() == 0]
    if not answers:
        raise Failure("none of the hosts in %s answers: %s. Try: ssh HOST true" % (path, ", ".join(hosts) or "the file is empty"))
    if len(answers) < len(hosts):
        print("sweep: these hosts do not answer, and are left out: %s" % ", ".join(host for host in hosts if host not in answers),
              file=sys.stderr)
    return answers


class GnuParallel:
    """Runs the seeds of a sweep, with `jobs` seeds at a time on each host."""

    def __init__(self, jobs, hosts):
        """jobs: seeds at a time; None: one per core. hosts: file of ssh hosts; None: this machine. Raises Failure if
        GNU parallel is not installed."""
        self.options = ["--jobs", str(jobs)] if jobs is not None else []
        self._hosts = hosts
        try:
            version = subprocess.check_output(["parallel", "--plain", "--will-cite", "--version"], stdin=subprocess.DEVNULL,
                                              stderr=subprocess.DEVNULL, universal_newlines=True)
        except (FileNotFoundError, subprocess.CalledProcessError):
            version = ""
        if not version.startswith("GNU parallel"):  # the package moreutils has another program named parallel
            raise Failure("the program parallel is not installed, or not GNU parallel: apt-get install parallel")

    def resume(self, folder, _tick):
        """Raises Failure if a Slurm job array of an earlier call may still be running in this folder."""
        if how_to_go_on(folder):
            raise Failure("%s. Delete %s if that job has ended" % (how_to_go_on(folder), job_file(folder)))

    def run(self, folder, seeds, tick):
        """Runs the seeds and returns when all have ended, whether they succeed or fail. Calls tick() every POLL_S
        seconds. Raises Failure if hosts are given and none answers.

        If tick() or a signal handler raises an exception, the method ends all seeds and raises the exception again.
        """
        hosts = hosts_that_answer(self._hosts) if self._hosts is not None else []
        command = PARALLEL + ["--joblog", folder.joblog] + self.options
        command += [word for host in hosts for word in ("--sshlogin", host)]
        command += [" ".join(DIE_WITH_PARENT + ["bash", shlex.quote(folder.script), "{}"]), ":::"] + [str(seed) for seed in seeds]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, env=environment_of_parallel())
        try:
            while process.poll() is None:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(POLL_S)
                tick()
        except BaseException:
            process.send_signal(signal.SIGINT)  # all versions of GNU parallel end their jobs after this signal
            process.wait()
            raise
