# Computes the numbers in figures and pages from the rows of all seeds: differences, predictions and returns.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

import pandas

from ddm_launch import run_folder
from ddm_launch.averages import holm, mean_and_error, sign_test
from ddm_launch.command import Failure

SCHEDULES = ("joint", "sequential", "v_p_only", "joint_random_init")  # values of training/schedule
LATE_FRAMES = (900, 1500)  # range of frames in which the paper's curve is level
# Tasks of the DeepMind Control Suite: name in the suite, and duration of a physics step [s]. There are PHYSICS_FRAMES
# steps between two images.
SUITE = {"suite_pendulum": ("pendulum_swingup", 0.02), "suite_reacher": ("reacher_easy", 0.02),
         "suite_reacher_hard": ("reacher_hard", 0.02), "suite_cartpole": ("cartpole_swingup", 0.01),
         "suite_acrobot": ("acrobot_swingup", 0.01)}
PHYSICS_FRAMES = 5


def read_table(*names):
    """Reads a CSV file. Raises Failure with the name of the file if it cannot be read."""
    return run_folder.read_table(os.path.join(*names), remedy="make it by `study reproduce`")


def variants(folder):
    """Finds the variants in a folder. Returns {name: path of its trials.csv}, sorted by name."""
    paths = sorted(glob.glob(os.path.join(folder, "*", "trials.csv")))
    return {os.path.basename(os.path.dirname(path)): path for path in paths}


def differences(folder, reference):
    """Differences between the success rate of each variant in a folder and that of the reference (a trials.csv), paired
    by seed.

    Returns a table with the columns variant, frames, seeds, difference, se, p (sign test), and p_holm over all variants
    at these frames. The column frames has single numbers, then the mean over all numbers that each variant has ("100 to
    400"), then the mean over all but the first. Raises Failure if the variants have no frames in common with the
    reference.
    """
    success = {name: read_table(path).pivot(index="frames", columns="seed", values="success")
               for name, path in variants(folder).items() if not os.path.samefile(path, reference)}
    preset = read_table(reference).pivot(index="frames", columns="seed", values="success")
    frames = sorted(set(preset.index).intersection(*(table.index for table in success.values())))
    if not success or not frames:
        raise Failure("%s must hold trials.csv of variants with the frames of %s: run each with as many trials" % (
            folder, reference))
    groups = {str(count): [count] for count in frames}
    groups.update(("%d to %d" % (some[0], some[-1]), some) for some in (frames, frames[1:]) if len(some) > 1)
    rows = []
    for text, group in groups.items():
        changes = {name: (table.loc[group] - preset.loc[group]).mean(skipna=False).dropna()
                   for name, table in success.items()}
        p = {name: sign_test(list(change)) for name, change in changes.items()}
        rows += [(name, text, len(change), *mean_and_error(list(change)), p[name], p_holm)
                 for (name, change), p_holm in zip(changes.items(), holm(list(p.values())))]
    return pandas.DataFrame(rows, columns=["variant", "frames", "seeds", "difference", "se", "p", "p_holm"])


def returns(path):
    """Mean return of the evaluations after each number of frames. Returns a table with the index frames and the columns
    mean and se."""
    groups = read_table(path).groupby("frames")["return"]
    return pandas.DataFrame({frames: mean_and_error(list(group)) for frames, group in groups}, index=["mean", "se"]).T


def predictions(folder, plant):
    """Prediction errors of each schedule, for the seeds that all schedules have. Returns {column: table [(steps, seed)
    x schedule]} of the columns ratio (rmse divided by the rmse of repeating the last frame) and position_r2."""
    found = {name: read_table(folder, plant + "_predictions", name, "predictions.csv").set_index(["steps", "seed"])
             for name in SCHEDULES}
    return {"ratio": pandas.DataFrame({name: table.rmse / table.rmse_repeat for name, table in found.items()}).dropna(),
            "position_r2": pandas.DataFrame({name: table.position_r2 for name, table in found.items()}).dropna()}


def late_success(folder):
    """Mean success over LATE_FRAMES, for the seeds that all schedules have  [seed x schedule]."""
    found = {name: read_table(folder, "" if name == "joint" else name, "trials.csv") for name in SCHEDULES}
    return pandas.DataFrame({name: table[table.frames.between(*LATE_FRAMES)].groupby("seed").success.mean()
                             for name, table in found.items()}).dropna()
