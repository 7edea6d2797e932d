# What a figure reads from a run folder: trials.csv, config.yaml and the greedy evaluation of each trial.
# SPDX-License-Identifier: BSD-3-Clause
"""A run folder is what experiment.launch and run_experiment write. Nothing here writes into it."""
import csv
import os

import yaml


class RunFolderError(Exception):
    """A run folder lacks something or holds something unreadable; the message names the file and the remedy."""


def unreadable(path, error):
    """The exception to raise for a file that cannot be read at all."""
    reason = getattr(error, "strerror", None) or error
    return RunFolderError("%s cannot be read (%s): is its folder a run folder?" % (path, reason))


def read_csv(path, columns):
    """The rows of a CSV file as dictionaries of strings.

    columns: those that must be there. Raises RunFolderError if the file is missing, lacks one or has no row.
    """
    try:
        with open(path, newline="") as stream:
            reader = csv.DictReader(stream)
            rows = list(reader)
            header = reader.fieldnames or []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise unreadable(path, error)
    missing = [column for column in columns if column not in header]
    if missing:
        raise RunFolderError("%s has no column %s, only: %s" % (path, ", ".join(missing), ", ".join(header)))
    if not rows:
        raise RunFolderError("%s has no row yet: wait for the first trial" % path)
    return rows


def number(row, column, path):
    """A cell as float. Raises RunFolderError if it is no number."""
    try:
        return float(row[column])
    except (TypeError, ValueError):
        raise RunFolderError("%s: column %s must hold numbers, got '%s'" % (path, column, row[column]))


class Trial:
    """One row of trials.csv: the model after a trial, and its greedy evaluation."""

    def __init__(self, row, path):
        self.trial = int(number(row, "trial", path))
        self.frames = int(number(row, "frames", path))  # image-torque pairs learned from
        self.success = None  # True, False, or None where it cannot be known
        if (row["success"] or "").strip():
            self.success = number(row, "success", path) > 0.5
        self.final_error_deg = None
        if (row["final_error_deg"] or "").strip():
            self.final_error_deg = abs(number(row, "final_error_deg", path))


def read_trials(folder):
    """All rows of FOLDER/trials.csv, oldest first."""
    path = os.path.join(folder, "trials.csv")
    rows = read_csv(path, ["trial", "frames", "success", "final_error_deg"])
    return [Trial(row, path) for row in rows]


def read_plant(folder):
    """Name of the plant, from FOLDER/config.yaml (experiment/plant)."""
    path = os.path.join(folder, "config.yaml")
    try:
        with open(path) as stream:
            return str(yaml.safe_load(stream)["experiment"]["plant"])
    except OSError as error:
        raise unreadable(path, error)
    except (yaml.YAMLError, KeyError, TypeError):
        raise RunFolderError("%s does not name the plant (key experiment/plant)" % path)


class Evaluation:
    """One greedy run. Lists of one entry per frame: frame k was shown at time_s[k], then torque_nm[k] acted."""

    def __init__(self, folder, trial):
        self.folder = os.path.join(folder, "evaluation_%03d" % trial)
        path = os.path.join(self.folder, "trajectory.csv")
        rows = read_csv(path, ["time_s", "angle_rad", "rate_rad_per_s"])
        start = number(rows[0], "time_s", path)
        self.time_s = [number(row, "time_s", path) - start for row in rows]
        self.angle_rad = [number(row, "angle_rad", path) for row in rows]
        self.rate_rad_per_s = [number(row, "rate_rad_per_s", path) for row in rows]
        path = os.path.join(self.folder, "torques.csv")
        rows = read_csv(path, ["torque_nm"])
        self.torque_nm = [number(row, "torque_nm", path) for row in rows]
        if len(self.time_s) < 2 or len(self.torque_nm) != len(self.time_s):
            raise RunFolderError("%s: trajectory.csv must have at least two rows and torques.csv as many, got %d and %d"
                                 % (self.folder, len(self.time_s), len(self.torque_nm)))
