# Describes and draws plants, by the program simulate and the Python bindings.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import math
import os
import subprocess

import numpy as np
from PIL import Image
import yaml

from ddm_launch.command import Failure, find_program
from ddm_launch.run_folder import read_setting, read_table, read_torques, read_yaml


class Joints:
    """Joints of a plant. facts: what `simulate --describe` prints, as a dictionary. names, columns (in trajectory.csv),
    units, goal: of each joint."""

    def __init__(self, plant):
        """Raises Failure with the program's message if it fails."""
        command = [find_program("simulate", "ddm_sim"), "--plant", plant, "--describe"]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True)
        if done.returncode != 0:
            raise Failure("'%s' does not describe its plant: %s" % (" ".join(command), done.stderr.strip()))
        self.facts = yaml.safe_load(done.stdout)
        self.columns = [name for name in self.facts["state"] if not name.endswith("_per_s")]
        self.names, self.units = zip(*(name.rsplit("_", 1) for name in self.columns))
        self.goal = np.array(self.facts["goal"][:len(self.columns)])

    def distances(self, a, b):
        """Distance of each joint between the positions a and b, for angles the short way round  [.. x joints]."""
        difference = np.abs(a - b)
        circular = np.array([unit == "rad" for unit in self.units])
        return np.where(circular, np.abs((difference + math.pi) % (2.0 * math.pi) - math.pi), difference)


# An episode that was simulated again. images: grey images, one more than torques  [N + 1 x size x size]. views: images for
# people, one for each torque, or none  [N x height x width x 3]. goal: goal image  [size x size]. torques: table with a
# column for each motor.
Episode = collections.namedtuple("Episode", "images views goal torques")


def grey(image):
    return np.asarray(Image.fromarray(image).convert("L"))


def draw_images(folder, start, torques=(), with_views=False, **episode):
    """Simulates the plant of a run folder, without disturbances of the camera. start: initial state. torques: [N x motors].
    with_views: whether to draw images for people, too. episode: seed and options of reset(), which select the goal of
    plants that draw it. Returns an Episode. Raises Failure if the Python bindings are missing."""
    try:
        import ddm_sim  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise Failure("the Python bindings draw the images, and are missing (%s): build with -DDDM_PYTHON=ON" % error) from None
    plant = read_setting(folder, "experiment/plant")
    try:
        env = ddm_sim.make(plant, plant=read_yaml(folder, "config.yaml").get("plant", {}))
    except ValueError as error:
        raise Failure("the plant %s of %s cannot be made (%s): if its file has moved, put it back" % (
            plant, folder, error)) from error
    seed = episode.pop("seed", 0)
    image, info = env.reset(seed=seed, options=dict(episode, start=start))
    images, views, goal = [grey(image)], [], grey(info["goal_image"])
    for torque in np.asarray(torques):
        if with_views:
            views.append(env.render())
        images.append(grey(env.step(torque)[0]))
    return Episode(np.array(images), np.array(views), goal, torques)


def draw_evaluation(run, trial, with_views=False):
    """Simulates an evaluation of a run folder again. Returns an Episode with one image and view for each torque. Raises
    Failure if the camera has lost frames, or if a file cannot be read."""
    folder = os.path.join(run, "evaluation_%03d" % trial)
    trajectory = read_table(os.path.join(folder, "trajectory.csv"), "time_s")
    if np.any(np.diff(trajectory.time_s) > 1.5 * float(read_setting(run, "plant/dt"))):
        raise Failure("in %s the camera has lost frames: only evaluations without camera/drop_rate can be drawn" % folder)
    torques = read_torques(folder)
    episode = draw_images(run, trajectory.drop(columns=["step", "time_s"]).iloc[0], torques, with_views, trial=trial,
                          evaluation=True, seed=int(read_setting(run, "experiment/seed")))
    return episode._replace(images=episode.images[:len(torques)])
