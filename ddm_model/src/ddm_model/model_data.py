# What the program model_data writes about a model and bags, read into NumPy.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os
import subprocess

import numpy as np
import roslib.packages
import yaml


class ModelDataError(Exception):
    """The program model_data is not there or has failed; it has said why itself."""


def write_model_data(model, bags, folder, options=()):
    """Runs model_data into a folder. Its progress and its errors go to our standard error."""
    programs = roslib.packages.find_node("ddm_model", "model_data")
    if not programs:
        raise ModelDataError("the program model_data is not there: build the workspace, then source its setup.bash")
    command = [programs[0], "--model", model, "--out", folder] + list(options) + ["--"] + list(bags)
    if subprocess.run(command, stdin=subprocess.DEVNULL).returncode != 0:
        raise ModelDataError("nothing was written")


def read_arrays(folder):
    """{name: array} of all .npy files in a folder."""
    return {name[:-len(".npy")]: np.load(os.path.join(folder, name))
            for name in sorted(os.listdir(folder)) if name.endswith(".npy")}


def read_columns(path):
    """{column: array of numbers, or list of texts where one is no number}."""
    with open(path, newline="") as stream:
        rows = list(csv.reader(stream))
    columns = {}
    for i, name in enumerate(rows[0]):
        texts = [row[i] for row in rows[1:]]
        try:
            columns[name] = np.array([float(text) for text in texts])
        except ValueError:
            columns[name] = texts
    return columns


def stacked(columns, name):
    """The columns name_1, name_2, ... side by side: an array [rows x number of them]."""
    names = [name + "_%d" % i for i in range(1, len(columns) + 1) if name + "_%d" % i in columns]
    return np.column_stack([columns[one] for one in names])


class ModelData:
    """Everything in a folder of model_data. Without bags `bags` and what comes after it are None."""

    def __init__(self, folder):
        with open(os.path.join(folder, "model.yaml")) as stream:
            self.facts = yaml.load(stream, Loader=yaml.BaseLoader)  # texts: an id like 12e45678 is no number
        self.options = self.facts["options"]
        self.model = read_arrays(os.path.join(folder, "model"))
        self.pictures = read_arrays(os.path.join(folder, "arrays"))
        plane = read_columns(os.path.join(folder, "plane.csv"))
        self.plane_low, self.plane_high = plane["low"], plane["high"]
        self.bags = self.frames = self.features = self.torques = self.spectrum = self.errors = self.variation = None
        if os.path.exists(os.path.join(folder, "bags.csv")):
            self._read_bags(folder)

    def _read_bags(self, folder):
        self.bags = read_columns(os.path.join(folder, "bags.csv"))
        self.frames = read_columns(os.path.join(folder, "features.csv"))
        self.features = stacked(self.frames, "z")
        self.torques = stacked(self.frames, "u")
        self.spectrum = read_columns(os.path.join(folder, "spectrum.csv"))
        self.errors = read_columns(os.path.join(folder, "prediction_errors.csv"))
        with open(os.path.join(folder, "images.yaml")) as stream:
            self.variation = float(yaml.safe_load(stream)["variation"])

    @property
    def goal_feature(self):
        """z_ref, None if the model has no goal image."""
        return self.model.get("goal_feature")

    @property
    def max_torque(self):
        """One for each motor [N m]."""
        return np.broadcast_to(self.model["max_torque"], (int(self.facts["torque_dim"]),))
