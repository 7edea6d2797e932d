# Describes and draws plants, by the program simulate and the Python bindings.
# SPDX-License-Identifier: BSD-3-Clause
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


def draw_images(folder, start, torques=(), **episode):
    """Simulates the plant of a run folder and returns its grey images, without disturbances of the camera
    [N + 1 x size x size]. start: initial state. torques: [N x motors]. episode: seed and options of reset(), which
    select the goal of plants that draw it. Raises Failure if the Python bindings are missing."""
    try:
        import ddm_sim  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise Failure("the Python bindings draw the images, and are missing (%s): build with -DDDM_PYTHON=ON" % error) from None
    plant = read_setting(folder, "experiment/plant")
    env = ddm_sim.make(plant, plant=read_yaml(os.path.join(folder, "config.yaml")).get("plant", {}))
    seed = episode.pop("seed", 0)
    images = [env.reset(seed=seed, options=dict(episode, start=start))[0]] + [env.step(torque)[0] for torque in torques]
    return np.array([np.asarray(Image.fromarray(image).convert("L")) for image in images])


def draw_evaluation(run, trial):
    """Simulates an evaluation of a run folder again. Returns (rendered images, one per torque  [N x size x size]; table
    of torques with a column for each motor). Raises Failure if the camera has lost frames, or if a file cannot be
    read."""
    folder = os.path.join(run, "evaluation_%03d" % trial)
    trajectory = read_table(os.path.join(folder, "trajectory.csv"), "time_s")
    if np.any(np.diff(trajectory.time_s) > 1.5 * float(read_setting(run, "plant/dt"))):
        raise Failure("in %s the camera has lost frames: only evaluations without camera/drop_rate can be drawn" % folder)
    torques = read_torques(folder)
    images = draw_images(run, trajectory.drop(columns=["step", "time_s"]).iloc[0], torques.values, trial=trial, evaluation=True,
                         seed=int(read_setting(run, "experiment/seed")))
    return images[:len(torques)], torques
