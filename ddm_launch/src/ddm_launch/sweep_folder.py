# The folder of a sweep: which seeds are finished, and the rows of all of them in one table.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import csv
import os
import shutil

import yaml

from ddm_launch.command import Failure
from ddm_launch.folder_lock import FolderLock
from ddm_launch.settings import differences, read_yaml
from ddm_model.plain_file import remove_unfinished, write_file

# Keys of config.yaml in which the seeds of one sweep may differ.
MAY_DIFFER = {"version", "renderer", "experiment/seed", "experiment/trials", "experiment/runs", "experiment/timeout",
              "sim/watchdog"}

FULL_BYTES = 1 << 20  # free space below which a disk may be why nothing was said


class SweepFolder:
    """The folder that --out names:

      sweep.yaml           what is run; another sweep in this folder is refused
      run_seed.sh          the command of one seed
      seed_NNNN/           the results of a seed, by the program itself
      logs/seed_NNNN.log   what the program said when it ran last
      joblog.tsv           GNU parallel's job log of the last call
      slurm_job            number, cluster and seeds of the job array while it is in the hands of Slurm
      sweep.csv            the rows of all finished seeds

    A context manager: at most one sweep holds the folder at a time.
    """

    def __init__(self, path, program):
        """Makes the folder, or opens that of the same sweep. Raises Failure if it holds another one."""
        self.path, self.program = os.path.abspath(path), program
        self.script, self.table, self.joblog = (
            os.path.join(self.path, name) for name in ("run_seed.sh", "sweep.csv", "joblog.tsv"))
        try:
            os.makedirs(os.path.join(self.path, "logs"), exist_ok=True)
            self._lock = FolderLock(self.path)
        except OSError as error:
            raise Failure("cannot write into the folder %s (%s): choose another with --out" % (self.path, error.strerror))
        with contextlib.ExitStack() as stack:
            stack.callback(self._lock.release)
            remove_unfinished(self.path)
            self._compare()
            stack.pop_all()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._lock.release()

    def _compare(self):
        path = os.path.join(self.path, "sweep.yaml")
        here = {"program": self.program.name, "options": self.program.options}
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
        """Whether the seed has its verdict, for as many trials as are asked for."""
        summary = read_yaml(os.path.join(self.seed_folder(seed), "summary.yaml"))
        trials = summary.get("trials")
        return summary.get("finished") is True and (
            self.program.trials is None or (isinstance(trials, int) and trials >= self.program.trials))

    def prepare(self, seeds):
        """Writes the script that runs a seed; what earlier calls said about these seeds is forgotten."""
        write_file(self.script, self.program.script(self.path))
        for seed in seeds:
            with contextlib.suppress(FileNotFoundError):
                os.remove(self.log(seed))

    def last_words(self, seed):
        """The last line that a seed's program said, and where the rest is."""
        try:
            with open(self.log(seed), errors="replace") as stream:
                lines = [line.strip() for line in stream if line.strip()]
        except OSError:
            return "it has not written anything yet"
        if lines:
            return "%s (%s)" % (lines[-1], self.log(seed))
        is_full = shutil.disk_usage(self.path).free < FULL_BYTES
        return "it said nothing%s (%s)" % (", is the disk full?" if is_full else "", self.log(seed))

    def collect(self, seeds):
        """Writes sweep.csv over the finished ones of these seeds; removes it if there are none.

        Returns ({seed: its last row}, {seed: what is wrong with it}), together all seeds.
        """
        last_rows, problems, lines, first = {}, {}, [], None
        for seed in sorted(seeds):
            if not self.is_finished(seed):
                problems[seed] = self.last_words(seed)
                continue
            try:
                header, rows = self._read_table(seed)
                first = first or (seed, header)
                self._require_equal(first, seed, header)
            except Failure as error:
                problems[seed] = str(error)
                continue
            lines += rows
            last_rows[seed] = next(csv.DictReader([header, rows[-1]]))
        if first:
            write_file(self.table, "\n".join([first[1]] + lines) + "\n")
        else:
            with contextlib.suppress(FileNotFoundError):
                os.remove(self.table)
        return last_rows, problems

    def _read_table(self, seed):
        """(header line, lines) of a finished seed, up to the trial asked for."""
        path = os.path.join(self.seed_folder(seed), self.program.table)
        try:
            with open(path, newline="") as stream:
                lines = stream.read().splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise Failure("%s cannot be read (%s): remove the folder, and the seed is run again" % (path, error))
        count = len(lines) - 1 if self.program.trials is None else self.program.trials + 1
        rows = list(csv.DictReader(lines))
        if not 1 <= count <= len(rows) or any(row.get("seed") != str(seed) for row in rows):
            raise Failure("%s must hold %s rows of seed %d: remove the folder, and the seed is run again"
                             % (path, "some" if self.program.trials is None else count, seed))
        return lines[0], lines[1:count + 1]

    def _require_equal(self, first, seed, header):
        """A table is about one experiment: same columns, same configuration as the first finished seed."""
        there, here = (read_yaml(os.path.join(self.seed_folder(k), "config.yaml")) for k in (first[0], seed))
        found = differences(there, here, MAY_DIFFER)
        if header != first[1]:
            found.append("columns of %s" % self.program.table)
        if found:
            raise Failure("%s is not the experiment of seed %d: %s; use another folder for it"
                             % (self.seed_folder(seed), first[0], ", ".join(found)))

    def versions(self, seeds):
        """All versions of the code that made the rows of these finished seeds. config.yaml names that of rows that do
        not."""
        found = set()
        for seed in seeds:
            begun = str(read_yaml(os.path.join(self.seed_folder(seed), "config.yaml")).get("version"))
            header, lines = self._read_table(seed)
            rows = csv.DictReader([header] + lines)
            found.update(begun if row.get("version", "?") == "?" else row["version"] for row in rows)
        return sorted(found)
