# What the program model_data writes about a model and bags, in NumPy, and the tables that come of it.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import io
import os
import subprocess
import tempfile

import matplotlib.image
import numpy as np
import roslib.packages
import yaml

from ddm_model.model import blurred, load

BLOCK_BYTES = 1 << 23  # of the images that are compared at a time


class ModelDataError(Exception):
    """A program of ddm_model is not there or has failed; it has said why itself."""


def run_program(name, *arguments, **options):
    """Runs a program of ddm_model. Its progress and its errors go to our standard error."""
    programs = roslib.packages.find_node("ddm_model", name)
    if not programs:
        raise ModelDataError("the program %s is not there: build the workspace, then source its setup.bash" % name)
    if subprocess.run([programs[0]] + list(arguments), **options).returncode != 0:
        raise ModelDataError("nothing was written")


def write_model_data(model, bags, folder, options=()):
    """Runs model_data into a folder."""
    run_program("model_data", "--model", model, "--out", folder, *options, "--", *bags, stdin=subprocess.DEVNULL)


class Decoder:
    """Images of features, decoded by a model file. rest: values of the features beyond those that are given."""

    def __init__(self, model, rest=()):
        self.model, self.rest = model, rest

    def decode(self, features):
        """Grey values, an array [number x size x size]."""
        features, text = np.array([np.append(z, self.rest) for z in features]), io.StringIO()
        np.savetxt(text, features, fmt="%.17g", delimiter=",", header=",".join(numbered("z", features.T)), comments="")
        with tempfile.TemporaryDirectory() as folder:
            run_program("decode_features", self.model, "--frames", folder, input=text.getvalue().encode())
            pictures = [matplotlib.image.imread(os.path.join(folder, name)) for name in sorted(os.listdir(folder))]
        return np.rint(255.0 * np.array(pictures)).astype(np.uint8)


def numbered(name, rows):
    """{name_1: first row, name_2: second row, ...}"""
    return {"%s_%d" % (name, i + 1): row for i, row in enumerate(rows)}


def read_arrays(folder, mmap_mode=None):
    """{name: array} of all .npy files in a folder. mmap_mode: "r" leaves them on disk."""
    return {name[:-len(".npy")]: np.load(os.path.join(folder, name), mmap_mode)
            for name in sorted(os.listdir(folder)) if name.endswith(".npy")}


def kept_by_pca(model, y):
    """Coordinates along the principal components [grey] of images y [N x D], and the images with those alone."""
    coordinates = (y - model["pca_mean"]) @ model["pca_basis"]
    return coordinates, model["pca_mean"] + coordinates @ model["pca_basis"].T


# mean_rms, pca_rms, reconstruction_rms: distance of each image, blurred, to the model's mean image, to what the principal
# components keep of it, to its reconstruction, root mean square over pixels [grey]  [N]. share: mean square of the
# images along each component over that of the whole images [-]  [pca_dim]. variation: root mean square over all pixels
# and images of their distance to the mean of these very images [grey].
ImageErrors = collections.namedtuple("ImageErrors", "mean_rms pca_rms reconstruction_rms share variation")


def image_errors(model, images, reconstructions):
    """images, reconstructions: grey values k = 255 y  [N x D]."""
    squares, component_squares = [], 0.0
    own_mean = blurred(model, images.mean(axis=0) / 255.0)
    block = max(1, BLOCK_BYTES // (8 * images.shape[1]))
    for begin in range(0, len(images), block):
        y, y_hat = blurred(model, images[begin:begin + block] / 255.0), reconstructions[begin:begin + block] / 255.0
        coordinates, kept = kept_by_pca(model, y)
        squares.append([np.mean(np.square(y - other), axis=1) for other in (model["pca_mean"], kept, y_hat, own_mean)])
        component_squares = component_squares + np.sum(np.square(coordinates), axis=0)
    of_mean, of_pca, of_reconstruction, of_own_mean = np.concatenate(squares, axis=1)
    whole = np.sum(of_mean) * images.shape[1]
    return ImageErrors(np.sqrt(of_mean), np.sqrt(of_pca), np.sqrt(of_reconstruction),
                       component_squares / whole if whole > 0.0 else component_squares, np.sqrt(np.mean(of_own_mean)))


# A prediction that is shown: frame it starts from, features and images predicted 0, 1, ... steps ahead.
Prediction = collections.namedtuple("Prediction", "frame features images")


class ModelData:
    """A model file, everything in a folder of model_data, and the errors of images. Without bags `bags` and what comes
    after it are None, and tables is empty. unpaired: {what: number of the bag and time since its first frame [s]  [2 x N]}.
    """

    def __init__(self, model, folder):
        with open(os.path.join(folder, "model.yaml")) as stream:
            self.facts = yaml.load(stream, Loader=yaml.BaseLoader)  # texts: an id like 12e45678 is not a number
        self.options = self.facts["options"]
        self.model = load(model).arrays
        self.bags = self.frames = self.features = self.torques = self.spectrum = self.errors = self.variation = self.unpaired = None
        self.tables, self.predictions = {}, {}
        if os.path.exists(os.path.join(folder, "bags.yaml")):
            self._read_bags(folder)

    def _read_bags(self, folder):
        with open(os.path.join(folder, "bags.yaml")) as stream:
            bags = yaml.load(stream, Loader=yaml.BaseLoader)
        texts = {name: [bag[name] for bag in bags] for name in bags[0]}
        self.bags = {name: cells if name in ("bag", "camera") else np.array(cells, dtype=float)
                     for name, cells in texts.items()}
        arrays = read_arrays(os.path.join(folder, "bags"), "r")
        self.images = arrays["images"].T.reshape(-1, *2 * [int(self.facts["image_size"])])
        self.reconstructions = arrays["reconstructions"].T.reshape(self.images.shape)
        self.features, self.torques = arrays["features"].T, arrays["torques"].T
        self.unpaired = {name: arrays[name.replace(" ", "_")] for name in ("images without torque", "torques without image")}
        errors = image_errors(self.model, arrays["images"].T, arrays["reconstructions"].T)
        self.variation = errors.variation
        number_of = [np.repeat(np.arange(len(sizes)), sizes)  # the bag and the piece of each frame
                     for sizes in (self.bags["frames"].astype(int), arrays["piece_sizes"])]
        self.frames = dict(bag=number_of[0], piece=number_of[1], time_s=arrays["times"],
                           **numbered("u", arrays["torques"]), **numbered("z", arrays["features"]),
                           mean_rms=errors.mean_rms, pca_rms=errors.pca_rms,
                           reconstruction_rms=errors.reconstruction_rms)
        self.spectrum = {"component": np.arange(1, len(errors.share) + 1), "variance": self.model["pca_variance"],
                         "share": errors.share}
        self.errors = dict(zip(("steps", "num_predictions", "rmse", "rmse_repeat", "rmse_mean_torque"),
                               arrays["prediction_errors"]))
        for name in ("steps", "num_predictions"):
            self.errors[name] = self.errors[name].astype(int)
        self.tables = {"bags.csv": texts, "features.csv": self.frames, "spectrum.csv": self.spectrum,
                       "prediction_errors.csv": self.errors}
        if len(self.errors["steps"]) > 0:
            self._read_predictions(arrays)

    def _read_predictions(self, arrays):
        for kind in ("typical", "worst"):
            self.predictions[kind] = Prediction(int(arrays[kind + "_frame"]), arrays[kind + "_features"].T,
                                                arrays[kind + "_images"].T.reshape(-1, *self.images.shape[1:]))
        shown = self.predictions.items()
        steps = np.arange(len(self.errors["steps"]) + 1)
        self.tables["predicted_features.csv"] = dict(
            kind=[kind for kind, _ in shown for _ in steps],
            frame=[prediction.frame for _, prediction in shown for _ in steps],
            steps=np.tile(steps, len(shown)),
            **numbered("z", np.concatenate([prediction.features for _, prediction in shown]).T))

    @property
    def goal_feature(self):
        """z_ref, None if the model has no goal image."""
        return self.model.get("goal_feature")

    @property
    def beyond_plane(self):
        """What all images of a feature plane have in common: the goal's features from the third on, else zeros."""
        goal = np.zeros(int(self.options["feature_dim"])) if self.goal_feature is None else self.goal_feature
        return goal[2:]

    @property
    def max_torque(self):
        """One for each motor [N m]."""
        return np.broadcast_to(self.model["max_torque"], (int(self.facts["torque_dim"]),))
