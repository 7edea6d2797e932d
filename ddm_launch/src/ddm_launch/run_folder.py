# Reads run folders, which experiment.launch and run_experiment write.
# SPDX-License-Identifier: BSD-3-Clause
import os

import yaml

from ddm_launch.command import Failure
from ddm_launch.settings import LOADER, read_yaml
from ddm_launch.tables import read_table


def read_trials(path):
    """Reads a trials.csv, or a sweep.csv with the trials of many seeds. Unknown values of success and final_error are
    NaN; final_error is the absolute value. Raises Failure as read_table() does, and if the table has two rows of a
    trial of a seed."""
    table = read_table(path, "seed", "trial", "frames", "success", "final_error", remedy="give a trials.csv or sweep.csv",
                       once=("seed", "trial"))
    return table.assign(final_error=table.final_error.abs())


def read_trajectory(folder):
    """Reads the pendulum's true state in one episode from FOLDER/trajectory.csv: one row per image, with time_s = 0 at
    the first image."""
    table = read_table(os.path.join(folder, "trajectory.csv"), "time_s", "angle_rad", "rate_rad_per_s")
    return table.assign(time_s=table.time_s - table.time_s[0])


def read_torques(folder):
    """Reads the torques of one episode from FOLDER/torques.csv, with a column for each motor."""
    path = os.path.join(folder, "torques.csv")
    motors = list(read_table(path))[1:-1]  # between the columns step and exploratory
    return read_table(path, *motors)[motors]


def is_finished(folder):
    """Whether summary.yaml says that the experiment is finished."""
    return read_yaml(os.path.join(folder, "summary.yaml")).get("finished") is True


def num_finished(folder):
    """Number of finished trials of an experiment that may still be running: rows of trials.csv."""
    try:
        # Binary mode, because the content may be damaged.
        with open(os.path.join(folder, "trials.csv"), "rb") as stream:
            return len(stream.read().splitlines()) - 1
    except FileNotFoundError:
        return 0


def read_setting(folder, block, key, meaning):
    """Returns one value of FOLDER/config.yaml as text. meaning: description of the value for the error message. Raises
    Failure if the file or the value is missing."""
    path = os.path.join(folder, "config.yaml")
    try:
        with open(path) as stream:
            return str(yaml.load(stream, Loader=LOADER)[block][key])
    except (OSError, UnicodeDecodeError) as error:
        raise Failure("%s cannot be read (%s): is its folder a run folder?" % (path, getattr(error, "strerror", None) or error))
    except (yaml.YAMLError, KeyError, TypeError):
        raise Failure("%s does not name the %s (key %s/%s)" % (path, meaning, block, key))
