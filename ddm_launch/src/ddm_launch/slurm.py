# Runs the seeds of a sweep as a job array of Slurm, with one task per seed.
# SPDX-License-Identifier: BSD-3-Clause
import getpass
import itertools
import os
import shutil
import signal
import subprocess
import sys
import time
import zlib

from ddm_launch.command import Failure, Interrupted
from ddm_model.plain_file import write_file

TASK = "ddm_task"  # begins the lines of squeue about tasks. A site may print other lines around them


def index_ranges(seeds):
    """Formats ascending seeds for sbatch: [0, 1, 2, 5] gives "0-2,5"."""
    groups = itertools.groupby(enumerate(seeds), lambda pair: pair[1] - pair[0])
    ranges = [[seed for _, seed in group] for _, group in groups]
    return ",".join("%d" % seeds[0] if len(seeds) == 1 else "%d-%d" % (seeds[0], seeds[-1]) for seeds in ranges)


def call(*command):
    """Runs a command of Slurm. Returns a CompletedProcess with exit code and output."""
    # Ignores the user's default options for squeue, which could hide tasks. All commands use the cluster of sbatch.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("SQUEUE_")}
    if "SBATCH_CLUSTERS" in environment:
        environment["SLURM_CLUSTERS"] = environment["SBATCH_CLUSTERS"]
    return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, errors="replace")


def job_name(folder):
    """Name of the job array in Slurm. Each folder of a sweep has its own name, so Slurm finds the array by this name."""
    return "ddm_sweep_%08x" % zlib.crc32(folder.path.encode())


def job_file(folder):
    """File that exists while the job array may be in the queue, which may be longer than the sweep runs."""
    return os.path.join(folder.path, "slurm_job")


def how_to_go_on(folder):
    """Message for the user that tells how to resume or cancel the job array; empty if none may be running."""
    if not os.path.exists(job_file(folder)):
        return ""
    return "the Slurm job {0} may be running. The same command waits for it, 'scancel --name {0}' cancels it".format(job_name(folder))


class SlurmArray:
    """Runs the seeds of a sweep as the tasks of one job array, at most `jobs` at a time.

    Only SIGINT (Ctrl-C) cancels the job array. If the sweep ends for another reason, for example by SIGHUP after a lost
    connection, the array continues, and a later call of resume() waits for it.
    """

    def __init__(self, jobs):
        """jobs: number of tasks at a time; None: as many as the cluster runs. Raises Failure if Slurm's programs are
        not installed."""
        self.jobs = jobs
        for name in ("sbatch", "squeue", "scancel"):
            if shutil.which(name) is None:
                raise Failure("the program %s is not installed: apt-get install slurm-client, on a machine of a Slurm "
                              "cluster" % name)

    def run(self, folder, seeds, tick):
        """Submits the seeds and returns when all tasks have ended, whether they succeed or fail. Calls tick() every few
        seconds.

        Raises Failure if sbatch does not confirm the job array.
        """
        array = index_ranges(seeds) + ("" if self.jobs is None else "%%%d" % self.jobs)
        log = os.path.join(folder.path, "logs", "seed_").replace("%", "%%") + "%4a.log"
        write_file(job_file(folder), job_name(folder) + "\n")
        done = call("sbatch", "--array", array, "--job-name", job_name(folder), "--ntasks", "1", "--cpus-per-task", "1",
                    "--output", log, "--open-mode", "append", folder.script)
        if done.returncode != 0:
            raise Failure("sbatch did not confirm the job array %s: %s\n"
                          "Remedy: set what your cluster wants in the variables that sbatch reads (SBATCH_PARTITION, ...). "
                          "Seeds are indices of the array: they must be less than MaxArraySize, see 'scontrol show config'. "
                          "If the array is in the queue all the same, the same command waits for it."
                          % (array, (done.stdout + done.stderr).strip() or "it said nothing"))
        print(done.stdout.strip(), flush=True)
        self.resume(folder, tick)

    def resume(self, folder, tick):
        """Waits for the job array that this call or an earlier one has submitted, if there is one."""
        if not os.path.exists(job_file(folder)):
            return
        of_job = ("--user", getpass.getuser(), "--name", job_name(folder))
        try:
            pause_s, was_silent = 0.5, False
            while True:
                done = call("squeue", "--noheader", *of_job, "--format", TASK + " %T")
                is_silent = done.returncode != 0 or "error" in done.stderr.lower()
                tick()
                if not is_silent and TASK not in done.stdout:
                    break
                if is_silent and not was_silent:
                    print("waiting for Slurm, which does not say whether the job %s is running: %s"
                          % (job_name(folder), (done.stderr + done.stdout).strip()), file=sys.stderr, flush=True)
                was_silent = is_silent
                time.sleep(pause_s)
                pause_s = min(5.0, 1.2 * pause_s)  # short intervals at first; at most 5 s, to keep the load on Slurm small
        except Interrupted as interruption:
            if interruption.number == signal.SIGINT and call("scancel", *of_job).returncode == 0:
                os.remove(job_file(folder))
            raise
        os.remove(job_file(folder))
