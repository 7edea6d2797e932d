# What is kept of PILCO's run folders: its policy searches, and the angles that it predicted next to the actual ones.
# SPDX-License-Identifier: BSD-3-Clause
import os

import yaml

from ddm_launch.command import Failure
from ddm_launch.run_folder import Trajectory, read_trials
from ddm_launch.tables import read_csv, unreadable

SEARCH_KEYS = ["gp_s", "policy_search_s", "sparse", "points", "iterations", "evaluations", "cost_before", "cost_after",
               "message"]  # of pilco.yaml, kept in this order
DISTRIBUTION_COLUMNS = ["seed", "trial", "frames", "kind", "step", "time_s", "angle_rad", "angle_std_rad"]
PREDICTED, EVALUATION, TRIAL = "predicted", "evaluation", "trial"  # values of `kind`


def read_search(folder, trial):
    """The values of SEARCH_KEYS of one trial."""
    path = os.path.join(folder, "trial_%03d" % trial, "pilco.yaml")
    try:
        with open(path) as stream:
            tree = yaml.safe_load(stream)
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise unreadable(path, error, "is its folder that of a run of PILCO?")
    missing = [key for key in SEARCH_KEYS if not isinstance(tree, dict) or key not in tree]
    if missing:
        raise Failure("%s has no %s: is its folder that of a run of PILCO?" % (path, ", ".join(missing)))
    return [tree[key] for key in SEARCH_KEYS]


def search_rows(folders):
    """Rows (seed, trial, frames, values of SEARCH_KEYS). folders: {seed: run folder}."""
    return [[seed, trial.trial, trial.frames] + read_search(folder, trial.trial)
            for seed, folder in folders.items() for trial in read_trials(folder)]


def predicted_angle(folder, trial):
    """Rows (time, mean, standard deviation) of the angle, as predicted after this trial [s, rad, rad]."""
    columns = ["time_s", "angle_rad_mean", "angle_rad_std"]
    rows = read_csv(os.path.join(folder, "trial_%03d" % trial, "prediction.csv"), dict.fromkeys(columns, float),
                    "only --method pilco_state predicts the angle")
    return [[row[column] for column in columns] for row in rows]


def actual_angle(folder, run, trial):
    """The same of a run, which has no standard deviation."""
    trajectory = Trajectory(os.path.join(folder, "%s_%03d" % (run, trial)))
    return [(time_s, angle_rad, None) for time_s, angle_rad in zip(trajectory.time_s, trajectory.angle_rad)]


def distribution_rows(folders, trials):
    """Rows of DISTRIBUTION_COLUMNS: the angle under the policy that was learned after each of these trials.

    folders: {seed: run folder}. The policy of a trial is executed twice: in its evaluation and in the next recorded
    trial, where there is one.
    """
    rows = []
    for seed, folder in folders.items():
        frames = {trial.trial: trial.frames for trial in read_trials(folder)}
        for trial in (trial for trial in trials if trial in frames):
            runs = [(PREDICTED, predicted_angle(folder, trial)),
                    (EVALUATION, actual_angle(folder, "evaluation", trial))]
            if trial + 1 in frames:
                runs.append((TRIAL, actual_angle(folder, "trial", trial + 1)))
            for kind, angles in runs:
                for step, (time_s, angle_rad, deviation) in enumerate(angles):
                    rows.append((seed, trial, frames[trial], kind, step, "%.3f" % time_s, "%.4f" % angle_rad,
                                 "" if deviation is None else "%.4f" % deviation))
    return rows
