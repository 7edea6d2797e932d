# Numbers behind the figures and pages: from the rows of all seeds to differences, predictions and returns.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

import pandas
import rosbag

import numpy as np

from ddm_launch import tables
from ddm_launch.averages import holm, mean_and_error, sign_test
from ddm_launch.command import Failure

SCHEDULES = ("joint", "sequential", "v_p_only", "joint_random_init")  # of training/schedule
LATE_FRAMES = (900, 1500)  # the paper's curve is level over these
# Tasks of the DeepMind Control Suite: name there, and a physics frame [s]. An image is PHYSICS_FRAMES of them.
SUITE = {"suite_pendulum": ("pendulum_swingup", 0.02), "suite_reacher": ("reacher_easy", 0.02),
         "suite_reacher_hard": ("reacher_hard", 0.02), "suite_cartpole": ("cartpole_swingup", 0.01),
         "suite_acrobot": ("acrobot_swingup", 0.01)}
PHYSICS_FRAMES = 5


def read_table(*names):
    """A CSV file. Raises Failure, which names it, if it cannot be read."""
    return tables.read_table(os.path.join(*names), remedy="make it by `study reproduce`")


def recorded_images(bag):
    """The grey images of a recorded trial, as the learner got them  [N x size x size]. Raises Failure, which names the bag,
    if it cannot be read."""
    try:
        with rosbag.Bag(bag) as recording:
            return np.array([np.frombuffer(message.data, np.uint8).reshape(message.height, message.width)
                             for topic, message, _ in recording.read_messages() if topic.endswith("image_raw")])
    except Exception as error:  # rosbag has a dozen types for what is damaged, and takes others from Python
        raise Failure("%s cannot be read (%s): `rosbag check` tells whether it is damaged" % (bag, error)) from error


def variants(folder):
    """{name: path of its trials.csv} of the folders in a folder, by name."""
    paths = sorted(glob.glob(os.path.join(folder, "*", "trials.csv")))
    return {os.path.basename(os.path.dirname(path)): path for path in paths}


def differences(folder, reference):
    """What each variant in a folder changes of the success rate of the reference, a trials.csv, paired by seed.

    Columns variant, frames, seeds, difference, se, p of the sign test, and p_holm over all variants at these frames. Frames
    are single numbers, then the mean over all that each variant has ("100 to 400") and over all but the first.
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
    """Mean return of the greedy episodes after each number of frames  [frames: mean, se]."""
    groups = read_table(path).groupby("frames")["return"]
    return pandas.DataFrame({frames: mean_and_error(list(group)) for frames, group in groups}, index=["mean", "se"]).T


def predictions(folder, plant):
    """Predictions of each schedule, of the seeds that all schedules have: {column: table [steps, seed: schedule ...]} of
    ratio, rmse over that of repeating the last frame, and position_r2."""
    found = {name: read_table(folder, plant + "_predictions", name, "predictions.csv").set_index(["steps", "seed"])
             for name in SCHEDULES}
    return {"ratio": pandas.DataFrame({name: table.rmse / table.rmse_repeat for name, table in found.items()}).dropna(),
            "position_r2": pandas.DataFrame({name: table.position_r2 for name, table in found.items()}).dropna()}


def late_success(folder):
    """Mean success over LATE_FRAMES of the seeds that all schedules have  [seed: schedule ...]."""
    found = {name: read_table(folder, "" if name == "joint" else name, "trials.csv") for name in SCHEDULES}
    return pandas.DataFrame({name: table[table.frames.between(*LATE_FRAMES)].groupby("seed").success.mean()
                             for name, table in found.items()}).dropna()
