# What figures and tables read from a run folder: trials.csv, config.yaml, and the plant's true state in each run.
# SPDX-License-Identifier: BSD-3-Clause
"""A run folder is what experiment.launch and run_experiment write. Nothing here writes into it."""
import csv
import math
import os

import yaml

from ddm_launch.sweep_folder import read_yaml

TRIAL_COLUMNS = ["trial", "frames", "success", "final_error_deg"]  # those of trials.csv that figures need


class RunFolderError(Exception):
    """A run folder lacks something or holds something unreadable; the message names the file and the remedy."""


def unreadable(path, error, remedy="is its folder a run folder?"):
    """The exception to raise for a file that cannot be read at all."""
    reason = getattr(error, "strerror", None) or error
    return RunFolderError("%s cannot be read (%s): %s" % (path, reason, remedy))


def read_csv(path, columns, remedy=None):
    """The rows of a CSV file as dictionaries of strings.

    columns: those that must be there. remedy: what to do if it is not there, for files of other folders than a run's.
    Raises RunFolderError if the file is missing, lacks one or has no row.
    """
    try:
        with open(path, newline="") as stream:
            reader = csv.DictReader(stream)
            rows = list(reader)
            header = reader.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise unreadable(path, error, remedy) if remedy else unreadable(path, error)
    missing = [column for column in columns if column not in header]
    if missing:
        raise RunFolderError("%s has no column %s, only: %s" % (path, ", ".join(missing), ", ".join(header)))
    if not rows:
        raise RunFolderError("%s has no row yet: %s" % (path, remedy or "wait for the first trial"))
    return rows


def number(row, column, path):
    """A cell as float. Raises RunFolderError if it is no number, or not a finite one."""
    try:
        value = float(row[column])
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise RunFolderError("%s: column %s must hold numbers, got '%s'" % (path, column, row[column]))
    return value


class Trial:
    """One row of trials.csv: the model after a trial, and its greedy evaluation."""

    def __init__(self, row, path):
        self.trial = int(number(row, "trial", path))
        self.frames = int(number(row, "frames", path))  # image-torque pairs learned from
        self.success = self.flag(row, "success", path)
        self.success_strict = self.flag(row, "success_strict", path)
        self.final_error_deg = None
        if (row["final_error_deg"] or "").strip():
            self.final_error_deg = abs(number(row, "final_error_deg", path))
        self.version = row.get("version") or "?"  # of the code that produced the row; older tables do not name it

    @staticmethod
    def flag(row, column, path):
        """True, False, or None where it cannot be known."""
        return number(row, column, path) > 0.5 if (row.get(column) or "").strip() else None


def read_trials(folder):
    """All rows of FOLDER/trials.csv, oldest first."""
    path = os.path.join(folder, "trials.csv")
    rows = read_csv(path, TRIAL_COLUMNS)
    return [Trial(row, path) for row in rows]


def read_sweep(path, remedy="give a trials.csv or sweep.csv"):
    """The trials of many experiments in one file, as {seed: list of Trial}.

    Raises RunFolderError as read_csv() does, and if a trial of a seed is there twice.
    """
    runs, seen = {}, set()
    for row in read_csv(path, ["seed"] + TRIAL_COLUMNS, remedy):
        seed, trial = int(number(row, "seed", path)), Trial(row, path)
        if (seed, trial.trial) in seen:
            raise RunFolderError("%s holds trial %d of seed %d twice: give each seed once" % (path, trial.trial, seed))
        seen.add((seed, trial.trial))
        runs.setdefault(seed, []).append(trial)
    return runs


def is_finished(folder):
    """Whether the run has its verdict."""
    return read_yaml(os.path.join(folder, "summary.yaml")).get("finished") is True


def num_finished(folder):
    """Number of finished trials of a run that may be under way: rows of trials.csv."""
    path = os.path.join(folder, "trials.csv")
    if not os.path.exists(path):
        return 0
    with open(path, "rb") as stream:  # whatever is in it
        return len(stream.read().splitlines()) - 1


def read_setting(folder, block, key, meaning):
    """One value of FOLDER/config.yaml as text. meaning: what it names, for the message of the RunFolderError."""
    path = os.path.join(folder, "config.yaml")
    try:
        with open(path) as stream:
            return str(yaml.safe_load(stream)[block][key])
    except (OSError, UnicodeDecodeError) as error:
        raise unreadable(path, error)
    except (yaml.YAMLError, KeyError, TypeError):
        raise RunFolderError("%s does not name the %s (key %s/%s)" % (path, meaning, block, key))


def read_plant(folder):
    """Name of the plant, from FOLDER/config.yaml (experiment/plant)."""
    return read_setting(folder, "experiment", "plant", "plant")


class Trajectory:
    """The pendulum's true state in one run, DIR/trajectory.csv: one entry per frame, time_s from the first one on."""

    def __init__(self, folder):
        path = os.path.join(folder, "trajectory.csv")
        rows = read_csv(path, ["time_s", "angle_rad", "rate_rad_per_s"])
        start = number(rows[0], "time_s", path)
        self.time_s = [number(row, "time_s", path) - start for row in rows]
        self.angle_rad = [number(row, "angle_rad", path) for row in rows]
        self.rate_rad_per_s = [number(row, "rate_rad_per_s", path) for row in rows]


class Evaluation(Trajectory):
    """One greedy run: frame k was shown at time_s[k], then torque_nm[k] acted."""

    def __init__(self, folder, trial):
        self.folder = os.path.join(folder, "evaluation_%03d" % trial)
        super().__init__(self.folder)
        path = os.path.join(self.folder, "torques.csv")
        rows = read_csv(path, ["torque_nm"])
        self.torque_nm = [number(row, "torque_nm", path) for row in rows]
        if len(self.time_s) < 2 or len(self.torque_nm) != len(self.time_s):
            raise RunFolderError("%s: trajectory.csv must have at least two rows and torques.csv as many, got %d and %d"
                                 % (self.folder, len(self.time_s), len(self.torque_nm)))
