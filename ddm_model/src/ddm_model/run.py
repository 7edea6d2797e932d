# Reads a run folder into pandas: its models, and each step of its trials and evaluations.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import re

import pandas as pd
import yaml

# config: effective configuration, as nested dictionaries.
# trials: table trials.csv, one row per model, indexed by trial.
# steps: one row per time step of all trials and evaluations, indexed by (kind, trial, episode, step), where kind is
# "trial" or "evaluation". Columns are those of torques.csv, trajectory.csv and goal_distance.csv: torques [N m],
# exploratory and, if known, the plant's true state and the distance to the goal [spread of the features].
Run = collections.namedtuple("Run", "config trials steps")

FOLDER = re.compile(r"(trial|evaluation)_(\d+)$")
EPISODE = re.compile(r"episode_(\d+)$")
STEP_TABLES = ("torques.csv", "trajectory.csv", "goal_distance.csv")
INDEX = ["kind", "trial", "episode", "step"]


class RunFolderError(ValueError):
    """The folder is not the run folder of an experiment, or a table in it is damaged."""


def _read_table(path, *columns):
    """Reads a CSV file. columns: required columns. Raises RunFolderError if the file cannot be read or lacks one of
    them."""
    remedy = "give a folder that experiment.launch or run_experiment has written"
    try:
        table = pd.read_csv(path, float_precision="round_trip")  # parses numbers without rounding
    except (OSError, ValueError) as error:  # pandas raises several kinds of ValueError for invalid contents
        raise RunFolderError("cannot read %s: %s; %s" % (path, getattr(error, "strerror", None) or error, remedy)) from error
    missing = [name for name in columns if name not in table.columns]
    if missing:
        raise RunFolderError("%s has no column '%s', only %s: %s" % (path, "', '".join(missing), ", ".join(table.columns), remedy))
    return table


def _read_config(folder):
    path = os.path.join(folder, "config.yaml")
    try:
        with open(path, encoding="utf-8") as stream:
            config = yaml.safe_load(stream)
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise RunFolderError("cannot read %s: %s" % (path, getattr(error, "strerror", None) or error)) from error
    if not isinstance(config, dict):
        raise RunFolderError("%s must hold the blocks of a configuration, and holds %r" % (path, config))
    return config


def _recordings(folder):
    """Yields (kind, trial, episode, folder) of each recording. Skips interrupted trials, which have no torques.csv."""
    for name in sorted(os.listdir(folder)):
        match = FOLDER.match(name)
        if not match:
            continue
        path = os.path.join(folder, name)
        episodes = [(int(found.group(1)), os.path.join(path, found.group(0)))
                    for found in map(EPISODE.match, sorted(os.listdir(path))) if found]
        for episode, where in [(0, path)] + episodes:
            if os.path.isfile(os.path.join(where, STEP_TABLES[0])):
                yield match.group(1), int(match.group(2)), episode, where


def _read_steps(folder):
    parts = []
    for kind, trial, episode, where in _recordings(folder):
        tables = [_read_table(os.path.join(where, name), "step").set_index("step") for name in STEP_TABLES
                  if os.path.isfile(os.path.join(where, name))]
        steps = pd.concat(tables, axis=1).reset_index()
        parts.append(steps.assign(kind=kind, trial=trial, episode=episode))
    if not parts:
        return pd.DataFrame(index=pd.MultiIndex.from_arrays([[]] * len(INDEX), names=INDEX))
    return pd.concat(parts, ignore_index=True).set_index(INDEX)


def read_run(folder):
    """Reads the folder of an experiment into a Run. The experiment may still be running.

    Raises RunFolderError if the folder is not a run folder, or if one of its tables cannot be read.
    """
    trials = _read_table(os.path.join(folder, "trials.csv"), "trial", "frames").set_index("trial")
    return Run(_read_config(folder), trials, _read_steps(folder))
