# Numbers behind the figures and pages: from the rows of all seeds to rates, differences and returns.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

import pandas

from ddm_launch.averages import holm, mean_and_error, sign_test, success_rates, wilson_interval
from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep

SCHEDULES = ("joint", "sequential", "v_p_only", "joint_random_init")  # of training/schedule
LATE_FRAMES = (900, 1500)  # the paper's curve is level over these
# Tasks of the DeepMind Control Suite: name there, and a physics frame [s]. An image is PHYSICS_FRAMES of them.
SUITE = {"suite_pendulum": ("pendulum_swingup", 0.02), "suite_reacher": ("reacher_easy", 0.02),
         "suite_reacher_hard": ("reacher_hard", 0.02), "suite_cartpole": ("cartpole_swingup", 0.01),
         "suite_acrobot": ("acrobot_swingup", 0.01)}
PHYSICS_FRAMES = 5


def read_table(*names):
    """A CSV file. Raises Failure, which names it, if it cannot be read."""
    path = os.path.join(*names)
    try:
        return pandas.read_csv(path, float_precision="round_trip")
    except (OSError, ValueError) as error:  # ValueError: whatever pandas finds wrong with its contents
        raise Failure("%s cannot be read (%s): make it by `study reproduce`" % (
            path, getattr(error, "strerror", None) or error)) from None


def rates(path, seeds=None):
    """Success of these seeds, or of all, at each number of frames of a trials.csv, with Wilson's 95 % interval
    [frames: rate, se, runs, low, high]."""
    runs = [trials for seed, trials in read_sweep(path).items() if seeds is None or seed in seeds]
    table = pandas.DataFrame(success_rates(runs), columns=["frames", "rate", "se", "runs"])
    table["low"], table["high"] = zip(*map(wilson_interval, table.rate, table.runs))
    return table.set_index("frames")


def variants(folder):
    """{name: path of its trials.csv} of the folders in a folder, by name."""
    paths = sorted(glob.glob(os.path.join(folder, "*", "trials.csv")))
    return {os.path.basename(os.path.dirname(path)): path for path in paths}


def differences(folder, reference):
    """What each variant in a folder changes of the success rate of the reference, a trials.csv, paired by seed.

    Columns variant, frames, seeds, difference, se, p of the sign test, and p_holm over all variants at these frames. Frames
    are single numbers, then the mean over all that each variant has ("100 to 400") and over all but the first.
    """
    tables = {name: read_table(path).pivot(index="frames", columns="seed", values="success")
              for name, path in variants(folder).items() if not os.path.samefile(path, reference)}
    preset = read_table(reference).pivot(index="frames", columns="seed", values="success")
    frames = sorted(set(preset.index).intersection(*(table.index for table in tables.values())))
    if not tables or not frames:
        raise Failure("%s must hold trials.csv of variants with the frames of %s: run each with as many trials" % (
            folder, reference))
    groups = {str(count): [count] for count in frames}
    groups.update(("%d to %d" % (some[0], some[-1]), some) for some in (frames, frames[1:]) if len(some) > 1)
    rows = []
    for text, group in groups.items():
        changes = {name: (table.loc[group] - preset.loc[group]).mean(skipna=False).dropna()
                   for name, table in tables.items()}
        p = {name: sign_test(list(change)) for name, change in changes.items()}
        rows += [(name, text, len(change), *mean_and_error(list(change)), p[name], p_holm)
                 for (name, change), p_holm in zip(changes.items(), holm(list(p.values())))]
    return pandas.DataFrame(rows, columns=["variant", "frames", "seeds", "difference", "se", "p", "p_holm"])


def returns(path):
    """Mean return of the greedy episodes after each number of frames  [frames: mean, se, physics_frames]."""
    groups = read_table(path).groupby("frames")["return"]
    table = pandas.DataFrame([mean_and_error(list(group)) for _, group in groups], columns=["mean", "se"],
                             index=[frames for frames, _ in groups])
    table["physics_frames"] = PHYSICS_FRAMES * table.index
    return table


def predictions(folder, plant):
    """Predictions of each schedule, of the seeds that all schedules have: {column: table [steps, seed: schedule ...]} of
    rmse, rmse_repeat [grey], their ratio, and position_r2."""
    tables = {name: read_table(folder, plant + "_predictions", name, "predictions.csv").set_index(["steps", "seed"])
              for name in SCHEDULES}
    found = {column: pandas.DataFrame({name: table[column] for name, table in tables.items()}).dropna()
             for column in ("rmse", "rmse_repeat", "position_r2")}
    return dict(found, ratio=found["rmse"] / found["rmse_repeat"])


def late_success(folder):
    """Mean success over LATE_FRAMES of the seeds that all schedules have  [seed: schedule ...]."""
    tables = {name: read_table(folder, "" if name == "joint" else name, "trials.csv") for name in SCHEDULES}
    return pandas.DataFrame({name: table[table.frames.between(*LATE_FRAMES)].groupby("seed").success.mean()
                             for name, table in tables.items()}).dropna()
