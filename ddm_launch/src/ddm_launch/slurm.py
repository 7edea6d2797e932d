# Engine of a sweep: a job array of Slurm, one task for each seed.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import contextlib
import os
import re
import shutil
import subprocess
import sys
import time

from ddm_launch.command import Failure, held_back
from ddm_model.plain_file import write_file

END_LIMIT_S = 120.0  # Slurm itself kills what does not end by KillWait, 30 s by default


def index_ranges(seeds):
    """Ascending seeds as sbatch writes them: [0, 1, 2, 5] is "0-2,5"."""
    ranges = []
    for seed in seeds:
        if ranges and ranges[-1][1] == seed - 1:
            ranges[-1][1] = seed
        else:
            ranges.append([seed, seed])
    return ",".join("%d" % a if a == b else "%d-%d" % (a, b) for a, b in ranges)


def call(*command):
    """Runs a command of Slurm. Returns (exit code, stdout, stderr)."""
    # what a user has set for squeue by hand must not hide tasks from us
    environment = {key: value for key, value in os.environ.items() if not key.startswith("SQUEUE_")}
    done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, universal_newlines=True)
    return done.returncode, done.stdout, done.stderr.strip()


def require_commands():
    for name in ("sbatch", "squeue", "scancel"):
        if shutil.which(name) is None:
            raise Failure("the program %s is not installed: apt-get install slurm-client, on a machine of a Slurm "
                             "cluster" % name)


def task_states(job):
    """How many tasks of a job are in each state, for those not at their end. None if Slurm does not answer."""
    code, output, error = call("squeue", "--noheader", "--array", "--jobs", job, "--format", "%T")
    if code == 0:
        return collections.Counter(output.split())
    return collections.Counter() if "Invalid job id" in error else None  # it forgets a job minutes after its end


def cancel(job):
    """Ends all tasks of a job. Returns when they have ended; raises Failure if they do not."""
    _, _, error = call("scancel", job)
    end = time.monotonic() + END_LIMIT_S
    while task_states(job) != collections.Counter():
        if time.monotonic() > end:
            raise Failure("Slurm has not ended job %s within %d s (%s): end it with 'scancel %s' before the next "
                             "sweep in this folder" % (job, END_LIMIT_S, error or "scancel said nothing", job))
        time.sleep(0.2)


def job_file(folder):
    """DIR/slurm_job: the job array in the hands of Slurm, which goes on when the sweep that sent it is killed."""
    return os.path.join(folder.path, "slurm_job")


def forget(folder):
    with contextlib.suppress(FileNotFoundError):
        os.remove(job_file(folder))


def end_left_over(folder):
    """Ends the job array that a killed sweep has left in this folder. Returns its number, or None."""
    if not os.path.exists(job_file(folder)):
        return None
    require_commands()
    with open(job_file(folder)) as stream:
        job = stream.read().strip()
    cancel(job)
    forget(folder)
    return job


class SlurmArray:
    """Runs the seeds of a sweep as the tasks of one job array, at most `jobs` at a time."""

    def __init__(self, jobs, terminal):
        """jobs: None for as many as the cluster gives. terminal: show a line with the state of the tasks."""
        self.jobs, self.terminal = jobs, terminal
        require_commands()

    def _submit(self, folder, seeds):
        array = index_ranges(seeds) + ("" if self.jobs is None else "%%%d" % self.jobs)
        log = os.path.join(folder.path, "logs", "seed_").replace("%", "%%") + "%4a.log"
        code, output, error = call("sbatch", "--parsable", "--array", array, "--job-name", "ddm_sweep",
                                   "--ntasks", "1", "--cpus-per-task", "1", "--output", log, "--open-mode", "append",
                                   folder.script)
        job = output.strip().split(";")[0]
        if code != 0 or not re.match(r"\d+$", job):
            raise Failure("sbatch refused the job array %s: %s\nRemedy: set what your cluster wants in the "
                             "variables that sbatch reads (SBATCH_PARTITION, ...). Seeds are indices of the array: "
                             "they must be less than MaxArraySize, see 'scontrol show config'." % (array, error))
        return job

    def run(self, folder, seeds, tick):
        """Returns when all tasks have ended, well or not. Calls tick(), which returns what to show, now and then.

        An exception out of tick(), or out of a signal handler, cancels the job first.
        """
        job = None
        try:
            with held_back():  # a job without a number could not be ended
                job = self._submit(folder, seeds)
                write_file(job_file(folder), job + "\n")
            if not self.terminal:
                print("Slurm job %s" % job, flush=True)
            self._wait(job, tick)
        except BaseException:
            if job is not None:
                cancel(job)
                forget(folder)
            raise
        finally:
            if self.terminal:
                sys.stderr.write("\n")
        forget(folder)

    def _wait(self, job, tick):
        pause_s = 0.5
        while True:
            states, text = task_states(job), tick()
            if self.terminal:
                counts = "Slurm does not answer" if states is None else ", ".join(
                    "%d %s" % (count, state.lower()) for state, count in sorted(states.items()))
                sys.stderr.write("\r\033[KSlurm job %s: %s finished%s" % (job, text, counts and "; " + counts))
                sys.stderr.flush()
            if states == collections.Counter():
                return
            time.sleep(pause_s)
            pause_s = min(5.0, 1.2 * pause_s)  # the end of a short sweep is seen soon, a long one asks seldom
