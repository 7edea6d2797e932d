# Engine of a sweep: a job array of Slurm, one task for each seed.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import time

from ddm_launch.command import Failure, Interrupted, held_back
from ddm_model.plain_file import write_file

END_LIMIT_S = 60.0  # Slurm itself kills what does not end by KillWait, 30 s by default
ANSWER_LIMIT_S = 300.0  # the commands of Slurm give up by themselves before that

# States of tasks that have not ended. One that lost its node or its place may be queued again.
ALIVE = {"BOOT_FAIL", "COMPLETING", "CONFIGURING", "LAUNCH_FAILED", "NODE_FAIL", "PENDING", "POWER_UP_NODE", "PREEMPTED",
         "RECONFIG_FAIL", "REQUEUED", "REQUEUE_FED", "REQUEUE_HOLD", "RESIZING", "RESV_DEL_HOLD", "RUNNING", "SIGNALING",
         "SPECIAL_EXIT", "STAGE_OUT", "STOPPED", "SUSPENDED", "UPDATE_DB"}

# Messages of sbatch after which the job array may be running: sbatch sent it, and heard no answer.
LOST_ANSWERS = ("timed out", "zero bytes were transmitted", "unexpected message", "connection reset",
                "message receive failure", "endpoint is not connected")


def index_ranges(seeds):
    """Ascending seeds as sbatch writes them: [0, 1, 2, 5] is "0-2,5"."""
    ranges = []
    for seed in seeds:
        if ranges and ranges[-1][1] == seed - 1:
            ranges[-1][1] = seed
        else:
            ranges.append([seed, seed])
    return ",".join("%d" % a if a == b else "%d-%d" % (a, b) for a, b in ranges)


def indices(ranges):
    """The set of seeds that index_ranges() wrote."""
    bounds = (part.split("-") for part in ranges.split(",") if part)
    return {seed for bound in bounds for seed in range(int(bound[0]), int(bound[-1]) + 1)}


def call(*command):
    """Runs a command of Slurm. Returns (exit code, stdout, stderr)."""
    # what a user has set for squeue by hand must not hide tasks from us
    environment = {key: value for key, value in os.environ.items() if not key.startswith("SQUEUE_")}
    try:
        done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, universal_newlines=True, errors="replace", timeout=ANSWER_LIMIT_S)
    except subprocess.TimeoutExpired:
        return 1, "", "%s timed out after %d s" % (command[0], ANSWER_LIMIT_S)
    return done.returncode, done.stdout, done.stderr.strip()


def require_commands():
    for name in ("sbatch", "squeue", "scancel"):
        if shutil.which(name) is None:
            raise Failure("the program %s is not installed: apt-get install slurm-client, on a machine of a Slurm "
                             "cluster" % name)


class Job(collections.namedtuple("Job", "number cluster ranges")):
    """A job array. cluster: empty for the one that Slurm's commands address by default. ranges: its seeds, as sbatch
    writes them."""

    def __str__(self):
        return "Slurm job %s%s" % (self.number, self.cluster and " of cluster " + self.cluster)

    def _command(self, name, *words):
        return [name] + (["-M", self.cluster] if self.cluster else []) + list(words)

    def states(self):
        """(how many tasks are in each state, for those that have not ended; None). Where Slurm does not answer, so that
        tasks may be running or not: (None, what it said)."""
        code, output, error = call(*self._command("squeue", "--noheader", "--array", "--jobs", self.number,
                                                  "--format", "%T"))
        # the name of the cluster or a site's banner may surround the states
        lines = [line.strip() for line in output.splitlines()]
        states = collections.Counter(line for line in lines if line in ALIVE)
        failed = code != 0 or (not states and "error" in error.lower())
        if failed and "invalid job id" not in (output + error).lower():  # that one Slurm has forgotten after its end
            return None, error or output.strip() or "squeue ended with code %d" % code
        return states, None

    def cancel(self):
        """Ends all tasks. Returns when they have ended; raises Failure if they do not."""
        command = self._command("scancel", self.number)
        _, _, error = call(*command)
        end = time.monotonic() + END_LIMIT_S
        while self.states()[0] != collections.Counter():
            if time.monotonic() > end:
                raise Failure("%s may still be running %d s after it was cancelled (%s): end it with '%s' before the "
                              "next sweep in this folder" % (self, END_LIMIT_S, error or "scancel said nothing",
                                                             " ".join(command)))
            time.sleep(0.2)

    def how_to_go_on(self):
        return ("%s may be running: the same command waits for it again, '%s' cancels it"
                % (self, " ".join(self._command("scancel", self.number))))


def job_file(folder):
    """DIR/slurm_job: the job array in the hands of Slurm, which goes on without the sweep that sent it."""
    return os.path.join(folder.path, "slurm_job")


def remember(job, folder):
    write_file(job_file(folder), "%s;%s\n%s\n" % job)


def forget(folder):
    with contextlib.suppress(FileNotFoundError):
        os.remove(job_file(folder))


def remembered(folder):
    """The job array of this folder that may be running, or None."""
    try:
        with open(job_file(folder)) as stream:
            match = re.match(r"(\d+)(?:;(\S*))?\n([\d,-]*)", stream.read())
    except FileNotFoundError:
        return None
    if match is None:
        raise Failure("%s must hold the number of a job array: make sure by 'squeue --me' that none runs in this folder, "
                      "then delete the file" % job_file(folder))
    return Job(match.group(1), match.group(2) or "", match.group(3))


class SlurmArray:
    """Runs the seeds of a sweep as the tasks of one job array, at most `jobs` at a time."""

    def __init__(self, jobs, terminal):
        """jobs: None for as many as the cluster gives. terminal: show a line with the state of the tasks."""
        self.jobs, self.terminal = jobs, terminal
        require_commands()

    def _submit(self, folder, seeds):
        ranges = index_ranges(seeds)
        array = ranges + ("" if self.jobs is None else "%%%d" % self.jobs)
        log = os.path.join(folder.path, "logs", "seed_").replace("%", "%%") + "%4a.log"
        code, output, error = call("sbatch", "--parsable", "--array", array, "--job-name", "ddm_sweep",
                                   "--ntasks", "1", "--cpus-per-task", "1", "--output", log, "--open-mode", "append",
                                   folder.script)
        # a site may print lines before and after the one of --parsable, also numbers below what they mean
        number = r"^[ \t]*(\d+)(?:;(\S*))?[ \t\r]*$"
        found = re.findall(r"(?<!:\n)" + number, output, re.MULTILINE) or re.findall(number, output, re.MULTILINE)
        if code == 0 and found:
            return Job(*found[-1], ranges)
        said = "\n".join(text for text in (output.strip(), error) if text) or "it said nothing"
        killed = code < 0 or code > 128
        if code == 0 or killed or found or any(text in said.lower() for text in LOST_ANSWERS):
            raise Failure("sbatch has not made clear whether it took the job array %s, which may be running: %s\n"
                          "Remedy: look for the array with 'squeue --me --name ddm_sweep'. If it is there, cancel it with "
                          "scancel before the next sweep in this folder." % (array, said))
        raise Failure("sbatch refused the job array %s: %s\nRemedy: set what your cluster wants in the "
                         "variables that sbatch reads (SBATCH_PARTITION, ...). Seeds are indices of the array: "
                         "they must be less than MaxArraySize, see 'scontrol show config'." % (array, said))

    def run(self, folder, seeds, tick):
        """Returns when all tasks have ended, well or not. Calls tick(), which returns what to show, now and then.

        Only SIGINT, the Ctrl-C of a person, cancels the job. It outlives any other exception, such as the SIGHUP of a
        connection that has dropped: remembered() then returns it.
        """
        with self._cancelled_by_ctrl_c(folder):
            with held_back():  # a job without a number could not be waited for
                job = self._submit(folder, seeds)
                remember(job, folder)
            self._watch(job, tick)
        forget(folder)

    def wait(self, folder, job, tick):
        """As run(), for a job array that was remembered()."""
        with self._cancelled_by_ctrl_c(folder):
            self._watch(job, tick)
        forget(folder)

    @contextlib.contextmanager
    def _cancelled_by_ctrl_c(self, folder):
        try:
            yield
        except Interrupted as interruption:
            job = remembered(folder)
            if interruption.number == signal.SIGINT and job is not None:
                job.cancel()
                forget(folder)
            raise
        finally:
            if self.terminal:
                with contextlib.suppress(OSError):  # it may be gone
                    sys.stderr.write("\n")

    def _watch(self, job, tick):
        pause_s, silent = 0.5, False
        if not self.terminal:
            print(job, flush=True)
        while True:
            (states, silence), text = job.states(), tick()
            if self.terminal:
                counts = "Slurm does not answer" if states is None else ", ".join(
                    "%d %s" % (count, state.lower()) for state, count in sorted(states.items()))
                sys.stderr.write("\r\033[K%s: %s finished%s" % (job, text, counts and "; " + counts))
                sys.stderr.flush()
            elif silence and not silent:
                print("waiting for Slurm, which does not say whether %s is running: %s" % (job, silence),
                      file=sys.stderr, flush=True)
            silent = states is None
            if states == collections.Counter():
                return
            time.sleep(pause_s)
            pause_s = min(5.0, 1.2 * pause_s)  # the end of a short sweep is seen soon, a long one asks seldom
