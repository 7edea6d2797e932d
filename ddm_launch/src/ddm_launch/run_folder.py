# What figures and tables read from a run folder, which experiment.launch and run_experiment write.
# SPDX-License-Identifier: BSD-3-Clause
import os

import yaml

from ddm_launch.command import Failure
from ddm_launch.settings import LOADER, read_yaml
from ddm_launch.tables import read_table


def read_trials(path):
    """The rows of a trials.csv, or of a sweep.csv with those of many seeds. success, final_error (without its sign): NaN
    where they are not known. Raises Failure as read_table() does, and if a trial of a seed is there twice."""
    table = read_table(path, "seed", "trial", "frames", "success", "final_error", remedy="give a trials.csv or sweep.csv",
                       once=("seed", "trial"))
    return table.assign(final_error=table.final_error.abs())


def read_trajectory(folder):
    """The pendulum's true state in one episode, FOLDER/trajectory.csv: a row for each image, time_s from the first one on."""
    table = read_table(os.path.join(folder, "trajectory.csv"), "time_s", "angle_rad", "rate_rad_per_s")
    return table.assign(time_s=table.time_s - table.time_s[0])


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
            return str(yaml.load(stream, Loader=LOADER)[block][key])
    except (OSError, UnicodeDecodeError) as error:
        raise Failure("%s cannot be read (%s): is its folder a run folder?" % (path, getattr(error, "strerror", None) or error))
    except (yaml.YAMLError, KeyError, TypeError):
        raise Failure("%s does not name the %s (key %s/%s)" % (path, meaning, block, key))
