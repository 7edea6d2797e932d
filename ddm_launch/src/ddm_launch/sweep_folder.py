# Class SweepFolder: the folder of a sweep with the script for one seed, and the results of all seeds.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import os
import pathlib
import platform
import shlex
import subprocess

import pandas
import yaml

from ddm_launch.command import BadOptions, Failure, find_program
from ddm_launch.run_folder import differences, read_yaml
from ddm_model.plain_file import remove_unfinished, write_file

# Programs that a sweep can run, and the table that each program writes into its folder.
TABLES = {"run_experiment": "trials.csv", "prediction_experiment": "predictions.csv"}

# Keys of config.yaml that may differ between the seeds of a sweep.
MAY_DIFFER = {"version", "renderer", "experiment/seed", "experiment/trials", "experiment/runs", "experiment/timeout",
              "sim/watchdog"}

# The kernel ends a process when its parent is killed, even if the parent could not end the process itself. Each process
# in the chain sweep - parallel - (ssh -) script - program has this protection.
DIE_WITH_PARENT = ["setpriv", "--pdeathsig", "KILL"]
# The program itself ends by SIGTERM, so that it can still remove the lock of its folder.
END_WITH_PARENT = ["setpriv", "--pdeathsig", "TERM"]

SCRIPT = """\
#!/bin/bash
# One seed of this sweep, by hand: bash run_seed.sh SEED. As a task of a Slurm job array the seed is its index.
seed=${{1:-${{SLURM_ARRAY_TASK_ID:?}}}}
name=$(printf seed_%04d "$seed")
exec >>{folder}/logs/"$name".log 2>&1
echo "seed $seed on $(uname -n)${{SLURM_JOB_ID:+, task ${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}} of Slurm}}"
. {setup} || exit
cd {working_folder} || exit
export OMP_NUM_THREADS=1  # a core for each seed
{command} --seed "$seed" --out {folder}/"$name"
code=$?
((code <= 128)) || echo "ended by signal $(kill -l "$code")"
exit "$code"
"""


def find_setup(program):
    """Path of the setup.bash that each seed sources first, also on other hosts. This is the file of the topmost
    workspace in CMAKE_PREFIX_PATH, which may have plants that the workspace of the program lacks. Raises Failure if no
    setup.bash exists."""
    prefix = os.path.dirname(os.path.dirname(os.path.dirname(program)))  # program is PREFIX/lib/ddm_launch/PROGRAM
    for folder in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) + [prefix]:
        path = os.path.join(folder, "setup.bash")
        if folder and os.path.isfile(path):
            return path
    raise Failure("there is no setup.bash in %s nor in CMAKE_PREFIX_PATH: source the workspace's devel/setup.bash" % prefix)


def lock(path):
    """Creates a lock file with the names of host and process. A file is used because the shared file systems of
    clusters may lack locks of the kernel. Each seed's program also locks its own folder, which protects the results.

    Raises Failure if a process that may be running has the lock, OSError if the file cannot be written.
    """
    host = pid = ""
    with contextlib.suppress(FileNotFoundError):
        with open(path, errors="replace") as stream:
            host, _, pid = stream.read().strip().partition(" ")
        if host == platform.node() and pid.isdigit() and not os.path.exists("/proc/" + pid):
            os.remove(path)  # that sweep has ended without removing it
    try:
        with open(path, "x") as stream:
            stream.write("%s %d\n" % (platform.node(), os.getpid()))
    except FileExistsError:
        raise Failure("another sweep is running in the folder %s: process %s on %s. Wait for it, or use another folder. If you are "
                      "sure that this process has ended, delete %s" % (os.path.dirname(path), pid or "?", host or "?", path)) from None
    except OSError:  # for example, the disk is full
        with contextlib.suppress(OSError):
            os.remove(path)
        raise


class SweepFolder:
    """The folder that --out names:

      sweep.yaml           program and options; another sweep in this folder is refused
      run_seed.sh          script for one seed
      seed_NNNN/           results of a seed
      logs/seed_NNNN.log   output of a seed's program in its last run
      joblog.tsv           GNU parallel's job log of the last call
      slurm_job            name of a Slurm job array that may be running
      .lock                host and process of the sweep that uses the folder
      sweep.csv            rows of all finished seeds

    A context manager: only one sweep uses the folder at a time.
    """

    def __init__(self, path, program, trials, options, seed):
        """program: a key of TABLES. trials: number of trials, or None for a program without trials. options: all other
        options of the program except seed and folder. seed: any of the seeds. Raises Failure if the program does not
        exist or refuses its options, or if the folder has another sweep. The folder is created after the options have
        been checked."""
        self.path, self.trials, self.title = os.path.abspath(path), trials, " ".join([program] + options)
        self.script, self.table, self.joblog, self._lock = (
            os.path.join(self.path, name) for name in ("run_seed.sh", "sweep.csv", "joblog.tsv", ".lock"))
        self._table_of_seed, self._program = TABLES[program], find_program(program)
        self._command = [self._program] + ([] if trials is None else ["--trials", str(trials)]) + options
        self._setup = find_setup(self._program)
        self._check_options(seed)
        try:
            os.makedirs(os.path.join(self.path, "logs"), exist_ok=True)
            lock(self._lock)
        except OSError as error:
            raise Failure("cannot write into the folder %s (%s): choose another with --out" % (self.path, error.strerror))
        try:
            remove_unfinished(self.path)
            self._require_same_sweep({"program": program, "options": options})
        except BaseException:
            self.__exit__()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pathlib.Path(self._lock).unlink(missing_ok=True)  # a user may have deleted it

    def _check_options(self, seed):
        """Runs the program with an output folder that cannot be created. With valid options the program fails for this
        reason before it computes anything. With invalid options it ends with code 2 and a message, and with --help it
        ends with code 0. Raises BadOptions in the last two cases."""
        done = subprocess.run(self._command + ["--seed", str(seed), "--out", os.devnull], stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, universal_newlines=True)
        if done.returncode in (0, 2):
            raise BadOptions(done.stderr.strip() or "'%s' runs no experiment: correct the options" % self.title)

    def _require_same_sweep(self, here):
        path = os.path.join(self.path, "sweep.yaml")
        if not os.path.exists(path):
            write_file(path, yaml.safe_dump(here, sort_keys=False))
            return
        found = differences(read_yaml(path), here)
        if found:
            raise Failure("the folder %s holds another sweep, use another folder:\n - %s"
                          % (self.path, "\n - ".join(found)))

    def seed_folder(self, seed):
        return os.path.join(self.path, "seed_%04d" % seed)

    def log(self, seed):
        return os.path.join(self.path, "logs", "seed_%04d.log" % seed)

    def is_finished(self, seed):
        summary = read_yaml(self.seed_folder(seed), "summary.yaml")
        trials = summary.get("trials")
        return summary.get("finished") is True and (
            self.trials is None or (isinstance(trials, int) and trials >= self.trials))

    def prepare(self, seeds):
        quoted = {name: shlex.quote(text) for name, text in (
            ("folder", self.path), ("setup", self._setup), ("working_folder", os.getcwd()))}
        write_file(self.script, SCRIPT.format(command=" ".join(map(shlex.quote, END_WITH_PARENT + self._command)), **quoted))
        for seed in seeds:
            pathlib.Path(self.log(seed)).unlink(missing_ok=True)

    def last_words(self, seed):
        """Last line of output of a seed's program, with the path of the log."""
        try:
            with open(self.log(seed), errors="replace") as stream:
                lines = [line.strip() for line in stream if line.strip()]
        except OSError:
            return "it has not written anything yet"
        return "%s (%s)" % (lines[-1] if lines else "it said nothing", self.log(seed))

    def collect(self, seeds):
        """Writes sweep.csv with the rows of all finished seeds. Removes the file if no seed is finished.

        Returns ({seed: table}, {seed: problem}), which together contain all seeds.
        """
        tables, problems = {}, {}
        for seed in sorted(seeds):
            try:
                if not self.is_finished(seed):
                    raise Failure(self.last_words(seed))
                table = self._read_table(seed)
                for first in list(tables)[:1]:
                    self._require_same_experiment(first, tables[first], seed, table)
                tables[seed] = table
            except Failure as error:
                problems[seed] = str(error)
        if tables:
            write_file(self.table, pandas.concat(tables.values()).to_csv(index=False))
        else:
            pathlib.Path(self.table).unlink(missing_ok=True)
        return tables, problems

    def _read_table(self, seed):
        """Table of a finished seed up to the requested trial. All cells are texts. Raises Failure if the table is
        damaged."""
        path = os.path.join(self.seed_folder(seed), self._table_of_seed)
        try:
            table = pandas.read_csv(path, dtype=str, keep_default_na=False)
        except (OSError, ValueError):  # pandas raises several kinds of ValueError for invalid contents
            table = pandas.DataFrame()
        count = max(1, len(table)) if self.trials is None else self.trials + 1
        if len(table) < count or set(table.get("seed", ())) != {str(seed)}:
            raise Failure("%s must hold %d rows of seed %d: remove the folder, and the seed is run again" % (path, count, seed))
        return table.head(count)

    def _require_same_experiment(self, first, first_table, seed, table):
        """Raises Failure if columns or configuration of this seed differ from those of the first finished seed."""
        there, here = (read_yaml(self.seed_folder(k), "config.yaml") for k in (first, seed))
        found = differences(there, here, MAY_DIFFER)
        if list(first_table) != list(table):
            found.append("columns of %s" % self._table_of_seed)
        if found:
            raise Failure("%s is not the experiment of seed %d: %s; use another folder for it"
                          % (self.seed_folder(seed), first, ", ".join(found)))
