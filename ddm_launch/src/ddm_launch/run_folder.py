# Reads run folders, which experiment.launch and run_experiment write, and other CSV and YAML files.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

import numpy as np
import pandas
import yaml

from ddm_launch.command import Failure
from ddm_model.model_data import ModelDataError, read_bags
from ddm_model.plain_file import write_file

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # CSafeLoader is ten times as fast


def read_yaml(*path):
    """Reads the mapping in a YAML file. Returns an empty mapping if the file is missing or has other content."""
    try:
        with open(os.path.join(*path)) as stream:
            tree = yaml.load(stream, Loader=LOADER)
    except (OSError, UnicodeDecodeError, yaml.YAMLError):
        return {}
    return tree if isinstance(tree, dict) else {}


def flat(tree, prefix=""):
    entries = {}
    for key, value in tree.items():
        entries.update(flat(value, "%s%s/" % (prefix, key)) if isinstance(value, dict) else {prefix + str(key): value})
    return entries


def differences(there, here, may_differ=()):
    """Returns one line of text for each key whose values differ. may_differ: keys that are not compared."""
    there, here = flat(there), flat(here)
    return ["%s: %s there, %s here" % (key, there.get(key, "nothing"), here.get(key, "nothing"))
            for key in sorted(set(there) | set(here)) if key not in may_differ and there.get(key) != here.get(key)]


def read_table(path, *numbers, remedy="is its folder a run folder?", once=()):
    """Reads a CSV file as a data frame.

    numbers: required columns, whose cells must be finite numbers or empty. once: columns whose combined values identify
    a row.
    Raises Failure with the remedy if the file cannot be read, lacks a column, has no row, has text in place of a
    number, or identifies two rows by the same values.
    """
    try:
        table = pandas.read_csv(path, float_precision="round_trip")
    except (OSError, ValueError) as error:  # pandas raises several kinds of ValueError for invalid contents
        raise Failure("%s cannot be read (%s): %s" % (path, getattr(error, "strerror", None) or error, remedy)) from None
    missing = [name for name in numbers if name not in table]
    if missing:
        raise Failure("%s has no column %s, only: %s" % (path, ", ".join(missing), ", ".join(table)))
    if table.empty:
        raise Failure("%s has no row yet: %s" % (path, remedy))
    for name in numbers:
        values = pandas.to_numeric(table[name], errors="coerce")
        wrong = table[name][table[name].notna() & ~np.isfinite(values)]
        if len(wrong) > 0:
            raise Failure("%s: column %s must hold numbers, got '%s'" % (path, name, wrong.iloc[0]))
    twice = table[table.duplicated(list(once))] if once else ()
    if len(twice) > 0:
        raise Failure("%s has two rows of %s: give each once" % (path, ", ".join("%s %s" % (name, twice[name].iloc[0]) for name in once)))
    return table


def write_table(path, rows, columns):
    """Writes a CSV file with six significant digits for floats; None is an empty cell. The file appears when it is
    complete. Raises OSError if the file cannot be written."""
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    write_file(path, pandas.DataFrame(rows, columns=columns).to_csv(index=False, float_format="%.6g"))


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


def read_images(run, trial, image_size):
    """Images of all trials up to this one, in the order in which they were recorded  [N x size x size]. Raises Failure if
    a bag cannot be read."""
    folders = [os.path.join(run, "trial_%03d" % number) for number in range(trial + 1)]
    episodes = [sorted(glob.glob(os.path.join(glob.escape(folder), "episode_*"))) for folder in folders]
    bags = [os.path.join(path, "trial.bag") for first, others in zip(folders, episodes) for path in [first, *others]]
    try:
        recorded = read_bags(bags, image_size, data_set=read_yaml(run, "config.yaml").get("data_set"))
        return np.concatenate([bag["images"] for bag in recorded])
    except (ModelDataError, ValueError) as error:
        raise Failure("the bags of %s cannot be read: %s" % (run, error)) from error


def is_finished(folder):
    return read_yaml(folder, "summary.yaml").get("finished") is True


def num_finished(folder):
    """Number of finished trials of an experiment that may still be running: rows of trials.csv."""
    try:
        # Binary mode, because the content may be damaged.
        with open(os.path.join(folder, "trials.csv"), "rb") as stream:
            return len(stream.read().splitlines()) - 1
    except FileNotFoundError:
        return 0


def read_setting(folder, key):
    """Returns one value of FOLDER/config.yaml. key: block/key. Raises Failure if the file or the value is missing."""
    path = os.path.join(folder, "config.yaml")
    value = flat(read_yaml(path)).get(key)
    if value is None:
        raise Failure("%s must give a value of %s: is its folder a run folder?" % (path, key))
    return value
