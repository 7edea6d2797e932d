# Runs the seeds of a sweep as a job array of Slurm, with one task per seed.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import itertools
import os
import re
import shutil
import signal
import subprocess
import sys
import time

from ddm_launch.command import Failure, Interrupted, held_back
from ddm_model.plain_file import write_file

# States of tasks that have not ended. Slurm may queue a task again that has lost its node or was preempted.
ALIVE = {"BOOT_FAIL", "COMPLETING", "CONFIGURING", "LAUNCH_FAILED", "NODE_FAIL", "PENDING", "POWER_UP_NODE", "PREEMPTED",
         "RECONFIG_FAIL", "REQUEUED", "REQUEUE_FED", "REQUEUE_HOLD", "RESIZING", "RESV_DEL_HOLD", "RUNNING", "SIGNALING",
         "SPECIAL_EXIT", "STAGE_OUT", "STOPPED", "SUSPENDED", "UPDATE_DB"}


def index_ranges(seeds):
    """Formats ascending seeds for sbatch: [0, 1, 2, 5] gives "0-2,5"."""
    groups = itertools.groupby(enumerate(seeds), lambda pair: pair[1] - pair[0])
    ranges = [[seed for _, seed in group] for _, group in groups]
    return ",".join("%d" % seeds[0] if len(seeds) == 1 else "%d-%d" % (seeds[0], seeds[-1]) for seeds in ranges)


def call(*command):
    """Runs a command of Slurm. Returns a CompletedProcess with exit code and output."""
    # Ignores the user's default options for squeue, which could hide tasks.
    environment = {key: value for key, value in os.environ.items() if not key.startswith("SQUEUE_")}
    return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True, errors="replace")


class Job(collections.namedtuple("Job", "number cluster")):
    """A job array. cluster: name of the cluster, or empty for Slurm's default cluster."""

    def __str__(self):
        return "Slurm job %s%s" % (self.number, self.cluster and " of cluster " + self.cluster)

    def command(self, name, *words):
        """Command line of a program of Slurm for the cluster of this job."""
        return [name] + (["-M", self.cluster] if self.cluster else []) + list(words)

    def ask(self):
        """Asks Slurm for the state of the array. Returns (whether tasks may be running, output of Slurm if it gave no
        answer)."""
        done = call(*self.command("squeue", "--noheader", "--array", "--jobs", self.number, "--format", "%T"))
        # Lines with the name of the cluster or messages of a site may surround the states.
        if ALIVE & {line.strip() for line in done.stdout.splitlines()}:
            return True, ""
        said = (done.stderr + done.stdout).strip()
        is_forgotten = "invalid job id" in said.lower()  # Slurm forgets a job some time after its end
        if is_forgotten or (done.returncode == 0 and "error" not in done.stderr.lower()):
            return False, ""
        return True, said or "squeue ended with code %d" % done.returncode

    def how_to_go_on(self):
        """Message for the user that tells how to resume or cancel the job."""
        return ("%s may be running. The same command waits for it, '%s' cancels it"
                % (self, " ".join(self.command("scancel", self.number))))


def job_file(folder):
    """File with the number of the job array. The array may run longer than the sweep that submitted it."""
    return os.path.join(folder.path, "slurm_job")


def remembered(folder):
    """Job array of this folder that may be running, or None. Raises Failure if the file has other content."""
    try:
        with open(job_file(folder)) as stream:
            match = re.match(r"(\d+)(?:;(\S*))?\s", stream.read())
    except FileNotFoundError:
        return None
    if match is None:
        raise Failure("%s must hold the number of a job array: make sure by 'squeue --me' that none runs in this folder, "
                      "then delete the file" % job_file(folder))
    return Job(match.group(1), match.group(2) or "")


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

    def _submit(self, folder, seeds):
        array = index_ranges(seeds) + ("" if self.jobs is None else "%%%d" % self.jobs)
        log = os.path.join(folder.path, "logs", "seed_").replace("%", "%%") + "%4a.log"
        done = call("sbatch", "--parsable", "--array", array, "--job-name", "ddm_sweep", "--ntasks", "1",
                    "--cpus-per-task", "1", "--output", log, "--open-mode", "append", folder.script)
        # A site may print lines around the output of --parsable, for example a number below the words that explain it.
        number = r"^[ \t]*(\d+)(?:;(\S*))?[ \t\r]*$"
        found = re.findall(r"(?<!:\n)" + number, done.stdout, re.MULTILINE) or re.findall(number, done.stdout, re.MULTILINE)
        if done.returncode != 0 or not found:
            raise Failure("sbatch did not confirm the job array %s, which may be running all the same: %s\n"
                          "Remedy: look for the array by 'squeue --me --name ddm_sweep', and cancel it by scancel before "
                          "the next sweep in this folder. If sbatch refused it, set what your cluster wants in the "
                          "variables that sbatch reads (SBATCH_PARTITION, ...). Seeds are indices of the array: they must "
                          "be less than MaxArraySize, see 'scontrol show config'."
                          % (array, (done.stdout + done.stderr).strip() or "it said nothing"))
        return Job(*found[-1])

    def run(self, folder, seeds, tick):
        """Submits the seeds and returns when all tasks have ended, whether they succeed or fail. Calls tick() every few
        seconds.

        Raises Failure if sbatch does not confirm the job array.
        """
        with held_back():  # a signal must not separate the submission from the note of its number
            write_file(job_file(folder), "%s;%s\n" % self._submit(folder, seeds))
        self.resume(folder, tick)

    def resume(self, folder, tick):
        """Waits for the job array that this call or an earlier one has submitted, if there is one."""
        job = remembered(folder)
        if job is None:
            return
        print(job, flush=True)
        try:
            self._watch(job, tick)
        except Interrupted as interruption:
            if interruption.number == signal.SIGINT and call(*job.command("scancel", job.number)).returncode == 0:
                os.remove(job_file(folder))
            raise
        os.remove(job_file(folder))

    @staticmethod
    def _watch(job, tick):
        pause_s, silence, was_silent = 0.5, "", False
        while True:
            may_run, silence = job.ask()
            tick()
            if not may_run:
                return
            if silence and not was_silent:
                print("waiting for Slurm, which does not say whether %s is running: %s" % (job, silence),
                      file=sys.stderr, flush=True)
            was_silent = bool(silence)
            time.sleep(pause_s)
            pause_s = min(5.0, 1.2 * pause_s)  # short intervals at first; at most 5 s, to keep the load on Slurm small
