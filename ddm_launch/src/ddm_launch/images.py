# Images: recorded ones, those of a plant in a given state, and those of features as a model decodes them.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess
import tempfile

import numpy as np
from PIL import Image
import rosbag

from ddm_launch.command import Failure
from ddm_launch.plant import describe_plant, simulator
from ddm_launch.run_folder import read_setting
from ddm_model.model import ModelFileError, load
from ddm_model.model_data import grey


def draw_images(command, text):
    """The images that a program with the option --frames DIR draws when it is given this text.

    Returns grey PIL images, in order. Raises Failure with the program's own words if it fails.
    """
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(command + ["--frames", folder], input=text, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, universal_newlines=True)
        names = sorted(name for name in os.listdir(folder) if name.endswith(".png"))
        if done.returncode != 0 or not names:
            raise Failure("'%s' drew no image: %s" % (" ".join(command), done.stderr.strip()))
        images = []
        for name in names:
            with Image.open(os.path.join(folder, name)) as image:
                images.append(image.convert("L"))
        return images


def recorded_images(bag):
    """The grey images of a recorded trial, as the learner got them  [N x size x size]. Raises Failure, which names the bag,
    if it cannot be read."""
    try:
        with rosbag.Bag(bag) as recording:
            return np.array([np.frombuffer(message.data, np.uint8).reshape(message.height, message.width)
                             for topic, message, _ in recording.read_messages() if topic.endswith("image_raw")])
    except Exception as error:  # rosbag has a dozen types for what is damaged, and takes others from Python
        raise Failure("%s cannot be read (%s): `rosbag check` tells whether it is damaged" % (bag, error)) from error


class Camera:
    """Images of a folder's plant in given states, drawn by the simulator with the folder's own configuration."""

    def __init__(self, folder):
        self.command = simulator(read_setting(folder, "experiment", "plant", "plant"),
                                 "--config", os.path.join(folder, "config.yaml"))
        self.plant = describe_plant(self.command)

    def shoot(self, *state):
        """The grey image of one state, e.g. angle [rad] and rate [rad/s] of the pendulum."""
        start = ",".join(repr(float(value)) for value in state)
        return draw_images(self.command + ["--start", start], ",".join(self.plant["torque"]) + "\n")[0]


def read_model(path):
    """The Model in a file. Raises Failure, which names the file, if it is none."""
    try:
        return load(path)
    except (OSError, ModelFileError) as error:
        raise Failure(str(error)) from None


class Decoder:
    """Images of features, decoded by a model."""

    def __init__(self, path):
        """Raises Failure, which names the file, if it is not a model."""
        self.path, self.model = path, read_model(path)

    def decode(self, features):
        """One grey image for each feature [feature_dim]. Raises Failure if the model has another number of them."""
        features, due = np.asarray(features, dtype=float), self.model.options["feature_dim"]
        if features.ndim != 2 or features.shape[1] != due:
            raise Failure("model %s: needs %d feature(s) of each image, got an array %s: take a model of the same run" % (
                self.path, due, features.shape))
        return [Image.fromarray(image) for image in grey(self.model.decode(features))]
