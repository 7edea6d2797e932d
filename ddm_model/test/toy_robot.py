# A robot for tests of the Python side: a blob that a torque moves around a circle; its bags and models.
# SPDX-License-Identifier: BSD-3-Clause
import os
import subprocess

import numpy as np
import rosbag
import roslib.packages
import rospy
from ddm_msgs.msg import Torque
from sensor_msgs.msg import Image

SIZE = 12
CONFIG = """image: {size: %d}
model: {pca_dim: 8, encoder_widths: [6], max_torque: 2.0%%s}
training: {max_iterations: 150%%s}
""" % SIZE


def find_program(name):
    return roslib.packages.find_node("ddm_model", name)[0]


def call(name, *arguments):
    """Runs a program of ddm_model. Returns (exit code, standard output and error)."""
    done = subprocess.run([find_program(name)] + [str(word) for word in arguments], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    return done.returncode, done.stdout


def image(angle, size=SIZE):
    """Grey values of a blob on a circle, an array [size x size]."""
    rows, columns = np.mgrid[0:size, 0:size] / (size - 1.0) - 0.5
    square = (columns - 0.3 * np.sin(angle)) ** 2 + (rows - 0.3 * np.cos(angle)) ** 2
    return np.round(255.0 * np.exp(-square / 0.04)).astype(np.uint8)


def image_message(stamp, grey, channels=1):
    message = Image(height=len(grey), width=len(grey), encoding={1: "mono8", 3: "rgb8"}[channels],
                    step=channels * len(grey), data=np.repeat(grey, channels).tobytes())
    message.header.stamp = stamp
    return message


def write_bag(path, num_frames=150, seed=1, size=SIZE, channels=1, image_topic="camera/image_raw", torque=None):
    """Random torques, 0.2 s between frames. torque: function of the random one. Returns images and torques."""
    random = np.random.RandomState(seed)
    angle, images, torques = 0.5 * seed, [], []
    with rosbag.Bag(path, "w") as bag:
        bag.write("goal_image", image_message(rospy.Time(10), image(3.0, size), channels), rospy.Time(10))
        for k in range(num_frames):
            u = float(random.uniform(-2.0, 2.0))
            u = u if torque is None else torque(u)
            stamp = rospy.Time.from_sec(10.0 + 0.2 * k)
            message = Torque(torque=[u])
            message.header.stamp = stamp
            images.append(image(angle, size))
            torques.append(u)
            bag.write(image_topic, image_message(stamp, images[-1], channels), stamp)
            bag.write("torque", message, stamp)
            angle += 0.3 * u
    return np.array(images), np.array(torques)


def train(folder, bags, model_options="", training_options="", more=()):
    """Trains on bags, with more keys of the blocks model and training, and more options. Returns the path of the model."""
    config, out = os.path.join(str(folder), "toy.yaml"), os.path.join(str(folder), "toy.ddm")
    with open(config, "w") as stream:
        stream.write(CONFIG % (model_options, training_options))
    code, output = call("train_from_bags", "--config", config, "--out", out, *more, *bags)
    assert code == 0, output
    return out
