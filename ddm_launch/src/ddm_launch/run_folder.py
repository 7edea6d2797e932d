# What figures and tables read from a run folder: trials.csv, config.yaml, and the plant's true state in each run.
# SPDX-License-Identifier: BSD-3-Clause
"""A run folder is what experiment.launch and run_experiment write. Nothing here writes into it."""
import collections
import os

import yaml

from ddm_launch.command import Failure
from ddm_launch.settings import LOADER, read_yaml
from ddm_launch.tables import convert, optional, read_csv, unreadable

# One row of trials.csv: the model after a trial, and its greedy evaluation. frames: image-torque pairs learned from.
# success, final_error: None where not known.
Trial = collections.namedtuple("Trial", "trial frames success final_error")

# Unit of the final errors of a run, and the largest one that counts as reached.
Goal = collections.namedtuple("Goal", "unit tolerance")

TRIAL_COLUMNS = {"trial": int, "frames": int, "success": optional(lambda text: convert(text, float) > 0.5),
                 "final_error": optional(lambda text: abs(convert(text, float)))}


def trial_of(row):
    return Trial(*(row[column] for column in Trial._fields))


def read_trials(folder):
    """All rows of FOLDER/trials.csv, oldest first."""
    return [trial_of(row) for row in read_csv(os.path.join(folder, "trials.csv"), TRIAL_COLUMNS)]


def read_goal(folder):
    """The Goal of a run, from FOLDER/config.yaml. Raises Failure if that file does not tell it."""
    path = os.path.join(folder, "config.yaml")
    try:
        with open(path) as stream:
            goal = yaml.load(stream, Loader=LOADER)["goal"]
        return Goal(str(goal["error_unit"]), float(goal["tolerance"]))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise unreadable(path, error)
    except (KeyError, TypeError, ValueError):
        raise Failure("%s does not tell what counts as success (keys goal/error_unit and goal/tolerance): take a run folder "
                      "with its own config.yaml" % path) from None


def read_sweep(path, remedy="give a trials.csv or sweep.csv"):
    """The trials of many experiments in one file, as {seed: list of Trial}.

    Raises Failure as read_csv() does, and if a trial of a seed is there twice.
    """
    runs = {}
    for row in read_csv(path, dict(TRIAL_COLUMNS, seed=int), remedy, ("seed", "trial")):
        runs.setdefault(row["seed"], []).append(trial_of(row))
    return runs


def is_finished(folder):
    """Whether the run has its verdict."""
    return read_yaml(os.path.join(folder, "summary.yaml")).get("finished") is True


def num_finished(folder):
    """Number of finished trials of a run that may be under way: rows of trials.csv."""
    try:
        with open(os.path.join(folder, "trials.csv"), "rb") as stream:  # whatever is in it
            return len(stream.read().splitlines()) - 1
    except FileNotFoundError:
        return 0


def read_setting(folder, block, key, meaning):
    """One value of FOLDER/config.yaml as text. meaning: what it names, for the message of the Failure."""
    path = os.path.join(folder, "config.yaml")
    try:
        with open(path) as stream:
            return str(yaml.safe_load(stream)[block][key])
    except (OSError, UnicodeDecodeError) as error:
        raise unreadable(path, error)
    except (yaml.YAMLError, KeyError, TypeError):
        raise Failure("%s does not name the %s (key %s/%s)" % (path, meaning, block, key))


class Trajectory:
    """The pendulum's true state in one run, DIR/trajectory.csv: one entry per frame, time_s from the first one on."""

    def __init__(self, folder):
        columns = ["time_s", "angle_rad", "rate_rad_per_s"]
        rows = read_csv(os.path.join(folder, "trajectory.csv"), dict.fromkeys(columns, float))
        self.time_s = [row["time_s"] - rows[0]["time_s"] for row in rows]
        self.angle_rad, self.rate_rad_per_s = ([row[column] for row in rows] for column in columns[1:])


class Evaluation(Trajectory):
    """One greedy run: frame k was shown at time_s[k], then torque_nm[k] acted."""

    def __init__(self, folder, trial):
        path = os.path.join(folder, "evaluation_%03d" % trial)
        super().__init__(path)
        self.torque_nm = [row["torque_nm"] for row in read_csv(os.path.join(path, "torques.csv"), {"torque_nm": float})]
        if len(self.time_s) < 2 or len(self.torque_nm) != len(self.time_s):
            raise Failure("%s: trajectory.csv must have at least two rows and torques.csv as many, got %d and %d"
                          % (path, len(self.time_s), len(self.torque_nm)))
