# study diagnose: shows why a task is not learned, by errors of features and predictions on the next trial.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import glob
import math
import os

import numpy as np
from tqdm import tqdm

from ddm_launch.command import Failure
from ddm_launch.plant import Joints
from ddm_launch.run_folder import read_setting, read_table, read_yaml, write_table
from ddm_model.model import load
from ddm_model.model_data import ModelDataError, read_bags

ABOUT = """\
Shows why a task is not learned. For each run folder it takes the last model but one and the images of the next trial,
which that model was not trained on:
  features    how far off is each joint, if it is read from the features: that of the nearest image learned from?
  prediction  how far off is it, if it is read from features predicted 1, 5 and 15 steps ahead under the torques that acted?
  goal        which share of the images learned from shows each joint within 20 degrees (or 0.1 m) of the goal? Not for
              plants whose goal is drawn in each trial.
Writes a row for each of these and each joint, with the median and the 90 % quantile."""

STEPS = (1, 5, 15)
BATCH = 1000  # features that are compared at a time
NEAR = {"rad": math.radians(20.0), "m": 0.1}  # largest distance of a frame that counts as near the goal
COLUMNS = ["task", "seed", "frames", "part", "steps", "joint", "unit", "median", "quantile_90", "share"]

# One recorded episode. images: grey values  [N x size x size]. torques: [N x torque_dim, N m]. positions: [N x joints,
# rad or m].
Episode = collections.namedtuple("Episode", "images torques positions")


def share_near_goal(joints, positions):
    """Share of positions [N x joints] whose joints are all near the goal. Raises Failure if NEAR lacks a unit."""
    if not set(joints.units) <= set(NEAR):
        raise Failure("positions must be in %s, got %s: take a run of another plant" % (" or ".join(NEAR), ", ".join(joints.units)))
    limits = np.array([NEAR[unit] for unit in joints.units])
    return np.mean(np.all(joints.distances(positions, joints.goal) < limits, axis=1))


def read_trial(run, trial, joints, image_size):
    first = os.path.join(run, "trial_%03d" % trial)
    folders = [first] + sorted(glob.glob(os.path.join(first, "episode_*")))
    bags = read_bags([os.path.join(folder, "trial.bag") for folder in folders], image_size)
    tables = [read_table(os.path.join(folder, "trajectory.csv"), *joints.columns)[joints.columns] for folder in folders]
    return [Episode(bag["images"], bag["torques"], table.to_numpy(float)[:len(bag["images"])])
            for bag, table in zip(bags, tables)]


def nearest_positions(learned, positions, features):
    """For each feature, the position at the nearest feature of a training image  [N x joints]."""
    half_squares = 0.5 * np.sum(learned ** 2, axis=1)
    nearest = [np.argmin(half_squares - some @ learned.T, axis=1)  # |a - z|^2 / 2 without the constant |z|^2 / 2
               for some in np.array_split(features, 1 + len(features) // BATCH)]
    return positions[np.concatenate(nearest)]


def predicted(model, episode, steps):
    """Predicts features `steps` ahead from each frame of an episode. Returns (predicted features, indices of the images
    that were recorded then)."""
    n = model.options["order"]
    starts = range(n - 1, len(episode.images) - steps)
    features = model.encode(episode.images)
    ahead = model.roll_out([features[now - n + 1:now + 1] for now in starts],
                           [episode.torques[now - n + 1:now + steps] for now in starts])
    return ahead[:, -1], [now + steps for now in starts]


def diagnose(run):
    """Diagnoses a finished run folder. Returns rows of COLUMNS. Raises Failure if the run has fewer than two models."""
    plant, seed = (read_setting(run, "experiment/" + name) for name in ("plant", "seed"))
    joints = Joints(plant)
    last = len(glob.glob(os.path.join(run, "trial_*", "model.ddm"))) - 1
    if last < 1:
        raise Failure("%s must have two trials at least, got %d: the second is what the first model has not learned from"
                      % (run, last + 1))
    model = load(os.path.join(run, "trial_%03d" % (last - 1), "model.ddm"))
    episodes = [episode for trial in range(last) for episode in read_trial(run, trial, joints, model.image_size)]
    held_out = read_trial(run, last, joints, model.image_size)
    positions = np.concatenate([episode.positions for episode in episodes])
    learned = np.concatenate([model.encode(episode.images) for episode in episodes])
    rows = []
    for steps in (0,) + STEPS:
        errors = []
        for episode in held_out:
            if steps and len(episode.images) <= steps + model.options["order"] - 1:
                continue
            features, numbers = predicted(model, episode, steps) if steps else (model.encode(episode.images), slice(None))
            errors.append(joints.distances(nearest_positions(learned, positions, features), episode.positions[numbers]))
        for name, unit, column in zip(joints.names, joints.units, np.concatenate(errors).T if errors else []):
            scale, shown = (180.0 / math.pi, "deg") if unit == "rad" else (1.0, unit)
            rows.append([plant, seed, len(positions), "prediction" if steps else "features", steps, name, shown,
                         scale * np.median(column), scale * np.quantile(column, 0.9), None])
    # Plants with goal_site draw another goal in each trial.
    if not read_yaml(run, "config.yaml")["plant"].get("goal_site"):
        rows.append([plant, seed, len(positions), "goal", None, "all", None, None, None, share_near_goal(joints, positions)])
    return rows


def work(options):
    rows = []
    for run in tqdm(options.runs, unit="run", disable=None):
        try:
            rows += diagnose(run)
        except (OSError, ModelDataError) as error:
            raise Failure("%s: %s" % (run, error))
    write_table(options.out, rows, COLUMNS)
    print("wrote %s" % options.out)


def add_arguments(parser):
    parser.add_argument("runs", nargs="+", metavar="RUN", help="run folders with their bags, one a seed")
    parser.add_argument("--out", required=True, metavar="FILE.csv", help="table to write")
