# Why a task is not learned: errors of features and predictions on the trial after, and whether the goal was seen.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import glob
import math
import os

import numpy as np
import rosbag
from tqdm import tqdm

from ddm_launch.command import Failure
from ddm_launch.images import recorded_images
from ddm_launch.plant import describe_plant, simulator
from ddm_launch.run_folder import read_setting
from ddm_launch.settings import read_yaml
from ddm_launch.tables import motors_of, read_columns, write_csv
from ddm_model.model import ModelFileError, load

ABOUT = """\
Shows why a task is not learned. For each run folder it takes the last model but one and the images of the next trial,
which that model was not trained on:
  features    how far off is each joint, if it is read from the features: that of the nearest image learned from?
  prediction  how far off is it, if it is read from features predicted 1, 5 and 15 steps ahead under the torques that acted?
  goal        which share of the images learned from shows each joint within 20 degrees (or 0.1 m) of the goal? Not for
              plants whose goal is drawn in each trial.
Writes a row for each of these and each joint, with the median and the 90 % quantile."""

STEPS = (1, 5, 15)
BATCH = 1000  # features compared at a time
NEAR = {"rad": math.radians(20.0), "m": 0.1}  # of the goal
COLUMNS = ["task", "seed", "frames", "part", "steps", "joint", "unit", "median", "quantile_90", "share"]

# One recorded run. images: grey values [N x D]. torques [N x torque_dim, N m]. positions [N x joints].
Episode = collections.namedtuple("Episode", "images torques positions")


class Joints:
    """What a plant says of its positions. names, columns of a trajectory.csv, units; goal: their values there."""

    def __init__(self, plant):
        facts = describe_plant(simulator(plant))
        self.columns = [name for name in facts["state"] if not name.endswith("_per_s")]
        self.names, self.units = zip(*(name.rsplit("_", 1) for name in self.columns))
        self.goal = np.array(facts["goal"][:len(self.columns)])
        unknown = sorted(set(self.units) - set(NEAR))
        if unknown:
            raise Failure("plant %s: positions must be in %s, got %s: take a run of another plant" % (
                plant, " or ".join(NEAR), ", ".join(unknown)))

    def distances(self, a, b):
        """Of positions a to positions b, angles around the circle  [.. x joints]."""
        difference = np.abs(a - b)
        circular = np.array([unit == "rad" for unit in self.units])
        return np.where(circular, np.abs((difference + math.pi) % (2.0 * math.pi) - math.pi), difference)

    def share_near_goal(self, positions):
        limits = np.array([NEAR[unit] for unit in self.units])
        return np.mean(np.all(self.distances(positions, self.goal) < limits, axis=1))


def read_episode(folder, joints):
    images = recorded_images(os.path.join(folder, "trial.bag"))
    torques = os.path.join(folder, "torques.csv")
    return Episode(images, read_columns(torques, motors_of(torques))[:len(images)],
                   read_columns(os.path.join(folder, "trajectory.csv"), joints.columns)[:len(images)])


def read_trial(run, trial, joints):
    """The Episodes of a trial."""
    folder = os.path.join(run, "trial_%03d" % trial)
    return [read_episode(each, joints) for each in [folder] + sorted(glob.glob(os.path.join(folder, "episode_*")))]


class ReadOut:
    """Positions of features: those of the nearest image that was learned from."""

    def __init__(self, features, positions):
        self._features, self._positions = features.T, positions
        self._half_squares = 0.5 * np.sum(features ** 2, axis=1)

    def __call__(self, features):
        """[N x joints]"""
        nearest = [np.argmin(self._half_squares - some @ self._features, axis=1)  # |a - z|^2 / 2, but for |z|^2 / 2
                   for some in np.array_split(features, 1 + len(features) // BATCH)]
        return self._positions[np.concatenate(nearest)]


def prediction_errors(model, episodes, read_out, steps, joints):
    """[predictions x joints]"""
    n, memory, errors = model.options["order"], model.options["order"] + model.options["delay"], []
    for episode in episodes:
        starts = range(memory - 1, len(episode.images) - steps)
        if len(starts) == 0:
            continue
        features = model.encode(episode.images)
        ahead = model.roll_out([features[now - n + 1:now + 1] for now in starts],
                               [episode.torques[now - memory + 1:now + steps] for now in starts])
        errors.append(joints.distances(read_out(ahead[:, -1]), episode.positions[[now + steps for now in starts]]))
    return np.concatenate(errors) if errors else []


def diagnose(run):
    """Rows of COLUMNS of a finished run folder."""
    plant, seed = (read_setting(run, "experiment", name, name) for name in ("plant", "seed"))
    config = read_yaml(os.path.join(run, "config.yaml"))
    joints = Joints(plant)
    last = len(glob.glob(os.path.join(run, "trial_*", "model.ddm"))) - 1
    if last < 1:
        raise Failure("%s must have two trials at least, got %d: the second is what the first model has not learned from"
                      % (run, last + 1))
    model = load(os.path.join(run, "trial_%03d" % (last - 1), "model.ddm"))
    learned = [episode for trial in range(last) for episode in read_trial(run, trial, joints)]
    held_out = read_trial(run, last, joints)
    positions = np.concatenate([episode.positions for episode in learned])
    read_out = ReadOut(np.concatenate([model.encode(episode.images) for episode in learned]), positions)
    head = [plant, seed, len(positions)]
    rows = []

    def add(part, steps, errors):
        for name, unit, column in zip(joints.names, joints.units, errors.T):
            scale, shown = (180.0 / math.pi, "deg") if unit == "rad" else (1.0, unit)
            rows.append(head + [part, steps, name, shown, scale * np.median(column), scale * np.quantile(column, 0.9), ""])

    found = np.concatenate([read_out(model.encode(episode.images)) for episode in held_out])
    add("features", 0, joints.distances(found, np.concatenate([episode.positions for episode in held_out])))
    for steps in STEPS:
        errors = prediction_errors(model, held_out, read_out, steps, joints)
        if len(errors) > 0:
            add("prediction", steps, errors)
    if not config["plant"].get("goal_site"):  # a goal that is drawn in each trial
        rows.append(head + ["goal", "", "all", "", "", "", joints.share_near_goal(positions)])
    return rows


def work(options):
    rows = []
    for run in tqdm(options.runs, unit="run", disable=None):
        try:
            rows += diagnose(run)
        except (ModelFileError, OSError, rosbag.ROSBagException) as error:
            raise Failure("%s: %s" % (run, error))
    write_csv(options.out, COLUMNS, rows)
    print("wrote %s" % options.out)


def add_arguments(parser):
    parser.add_argument("runs", nargs="+", metavar="RUN", help="run folders with their bags, one a seed")
    parser.add_argument("--out", required=True, metavar="FILE.csv", help="table to write")
