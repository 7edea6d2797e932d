# Class ModelData: applies a model to bags and computes features, reconstructions, predictions and their errors.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import subprocess
import tempfile

import numpy as np
import roslib.packages
import yaml

from ddm_model.model import preprocessed

BLOCK_BYTES = 1 << 23  # images that are processed in one block [bytes]
MAX_STARTS = 1000  # largest number of predictions, which limits the time to seconds


class ModelDataError(Exception):
    """A bag cannot be read, or belongs to a robot with another number of motors than the model."""


def read_bags(paths, image_size, options=(), data_set=None):
    """Reads bags by the program read_bags. Returns a dictionary for each bag: camera, interval_s, goal, segment_sizes,
    notes, torque_dim, images [N x size x size], torques [N x torque_dim, N m], times of the images [s], and the times
    of images without torque and of torques without image [s].

    options: of the program read_bags; they override data_set, a block `data_set` as a dictionary.
    Raises ModelDataError if the program is missing or fails; the program prints its errors on standard error.
    """
    programs = roslib.packages.find_node("ddm_model", "read_bags")
    if not programs:
        raise ModelDataError("the program read_bags is not there: build the workspace, then source its setup.bash")
    with tempfile.TemporaryDirectory() as folder:
        config = os.path.join(folder, "data_set.yaml")
        with open(config, "w") as stream:
            yaml.safe_dump({"data_set": data_set or {}}, stream)
        command = [programs[0], "--image-size", str(image_size), "--out", folder, "--config", config, *options, "--", *paths]
        if subprocess.run(command, stdin=subprocess.DEVNULL).returncode != 0:
            raise ModelDataError("nothing was written")
        return [_read_arrays(os.path.join(folder, str(i)), image_size) for i in range(len(paths))]


def _read_arrays(folder, image_size):
    with open(os.path.join(folder, "bag.yaml")) as stream:
        bag = yaml.safe_load(stream)
    for name in ("images", "torques", "times", "images_without_torque", "torques_without_image"):
        bag[name] = np.fromfile(os.path.join(folder, name), np.uint8 if name == "images" else np.float64)
    bag["images"] = bag["images"].reshape(-1, image_size, image_size)
    bag["torques"] = bag["torques"].reshape(-1, bag["torque_dim"])
    return bag


def numbered(name, rows):
    """Dictionary {name_1: first row, name_2: second row, ...}."""
    return {"%s_%d" % (name, i + 1): row for i, row in enumerate(rows)}


def grey(y):
    """Grey values 255 y of images y, rounded to bytes like the images of a camera."""
    return np.rint(255.0 * np.clip(y, 0.0, 1.0)).astype(np.uint8)


def blocks(number, num_pixels):
    """Slices of `number` images such that each slice has at most BLOCK_BYTES."""
    size = max(1, BLOCK_BYTES // (8 * num_pixels))
    return [slice(begin, begin + size) for begin in range(0, number, size)]


def kept_by_pca(arrays, y):
    """Projects blurred images y [N x D] on the principal components. Returns (coordinates [N x pca_dim, grey], images
    that are reconstructed from the coordinates [N x D])."""
    coordinates = (y - arrays["pca_mean"]) @ arrays["pca_basis"]
    return coordinates, arrays["pca_mean"] + coordinates @ arrays["pca_basis"].T


# mean_rms, pca_rms, reconstruction_rms: distance of each blurred image to the model's mean image, to its projection on
# the principal components, and to its reconstruction; root mean square over pixels [grey]  [N].
# share: mean square of the images along each component, divided by the mean square of the whole images [-]  [pca_dim].
# variation: distance of the images (not blurred) to their own mean; root mean square over all pixels and images [grey].
ImageErrors = collections.namedtuple("ImageErrors", "mean_rms pca_rms reconstruction_rms share variation")


def image_errors(arrays, images, reconstructions):
    """Computes ImageErrors. arrays: of the model. images, reconstructions: grey values 255 y  [N x D]."""
    squares, component_squares = [], 0.0
    own_mean = images.mean(axis=0) / 255.0
    for block in blocks(*images.shape):
        raw, y_hat = images[block] / 255.0, reconstructions[block] / 255.0
        y = preprocessed(arrays, raw)
        coordinates, kept = kept_by_pca(arrays, y)
        pairs = (y, arrays["pca_mean"]), (y, kept), (y, y_hat), (raw, own_mean)
        squares.append([np.mean(np.square(image - other), axis=1) for image, other in pairs])
        component_squares = component_squares + np.sum(np.square(coordinates), axis=0)
    of_mean, of_pca, of_reconstruction, of_own_mean = np.concatenate(squares, axis=1)
    whole = np.sum(of_mean) * images.shape[1]
    return ImageErrors(np.sqrt(of_mean), np.sqrt(of_pca), np.sqrt(of_reconstruction),
                       component_squares / whole if whole > 0.0 else component_squares, np.sqrt(np.mean(of_own_mean)))


def prediction_starts(segment_sizes, order, steps):
    """Indices of frames that have order - 1 frames before them and `steps` frames after them in the same segment.
    Returns at most MAX_STARTS indices, evenly spread over all."""
    begins = np.cumsum(segment_sizes) - segment_sizes
    starts = np.concatenate([begin + np.arange(order - 1, size - steps) for begin, size in zip(begins, segment_sizes)])
    number = min(len(starts), MAX_STARTS)
    return starts[np.arange(number) * len(starts) // max(number, 1)]


def predicted_features(model, features, torques, starts, steps, told=None):
    """Rollouts of features from the frames `starts`, 0, 1, ... steps ahead  [starts x steps + 1 x feature_dim].

    told: a torque that replaces the recorded torques from the start on.
    """
    n = model.options["order"]
    past, known = features[starts[:, None] + np.arange(1 - n, 1)], torques[starts[:, None] + np.arange(1 - n, steps)]
    if told is not None:
        known[:, n - 1:] = told
    return np.concatenate([past[:, -1:], model.roll_out(past, known)], axis=1)


def prediction_errors(model, images, starts, predicted, blind):
    """Errors of rollouts 1, 2, ... steps ahead, root mean square over the pixels of all blurred images [grey]  [3 x
    steps].

    Rows: the predictions, the last image repeated, and the predictions `blind`, which were made with the mean torque.
    """
    squares, num_pixels = np.zeros((3, predicted.shape[1] - 1)), images[0].size
    for block in blocks(len(starts), num_pixels):
        stays = preprocessed(model.arrays, images[starts[block]].reshape(-1, num_pixels) / 255.0)
        for k in range(1, predicted.shape[1]):
            truth = preprocessed(model.arrays, images[starts[block] + k].reshape(-1, num_pixels) / 255.0)
            shown = grey(model.decode(predicted[block, k])) / 255.0, stays, grey(model.decode(blind[block, k])) / 255.0
            squares[:, k - 1] += [np.sum(np.square(image.reshape(truth.shape) - truth)) for image in shown]
    return np.sqrt(squares / (len(starts) * num_pixels))


# One rollout for the report: its first frame, and the features and images 0, 1, ... steps ahead.
Prediction = collections.namedtuple("Prediction", "frame features images")


class ModelData:
    """A Model and its results on bags. Without bags, `bags` and the attributes after it are None, and `tables` is
    empty.

    unpaired: {kind: index of the bag and time since its first frame [s]  [2 x N]} of images and torques without a
    partner.
    notes: pairs (bag, remark).
    """

    def __init__(self, model, bags=(), steps=15, options=(), say=lambda text: None):
        """steps: length of the longest rollout. options: options of read_bags, which override the data_set of the
        model. say: function that is called with progress messages.

        Raises ModelDataError if a bag cannot be read or belongs to another robot.
        """
        self.model = model
        self.bags = self.frames = self.features = self.torques = self.spectrum = self.errors = None
        self.variation = self.unpaired = None
        self.notes = []
        self.tables, self.predictions = {}, {}
        if bags:
            say("reading %d bag(s)" % len(bags))
            segment_sizes, times = self._read_bags(bags, options)
            self._judge_images(segment_sizes, times)
            self._predict(segment_sizes, steps, say)

    def _read_bags(self, paths, options):
        """Reads all bags. Returns the sizes of all segments and the times of all frames [s]."""
        own = yaml.safe_load(self.model.info["config"]) or {}
        bags = read_bags(paths, self.model.image_size, options, own.get("data_set"))
        for path, bag in zip(paths, bags):
            if bag["torque_dim"] != self.model.torque_dim:
                raise ModelDataError("bag %s: has %d torque(s) a frame, the model has %d: it is of another robot" % (
                    path, bag["torque_dim"], self.model.torque_dim))
        self.images, self.torques, times, segment_sizes = (
            np.concatenate([bag[name] for bag in bags]) for name in ("images", "torques", "times", "segment_sizes"))
        unpaired = ("images_without_torque", "torques_without_image")
        self.unpaired = {name.replace("_", " "): np.array(
            [(i, time) for i, bag in enumerate(bags) for time in bag[name]]).reshape(-1, 2).T for name in unpaired}
        self.bags = {"bag": paths, "camera": [bag["camera"] for bag in bags],
                     **{key: np.array([len(bag[name]) for bag in bags])
                        for key, name in (("frames", "times"), ("segments", "segment_sizes"), *zip(unpaired, unpaired))},
                     **{name: np.array([bag[name] for bag in bags]) for name in ("interval_s", "goal")}}
        self.notes = [(path, note) for path, bag in zip(paths, bags) for note in bag["notes"]]
        self.tables["bags.csv"] = self.bags
        return segment_sizes, times

    def _judge_images(self, segment_sizes, times):
        shape = len(self.images), self.images[0].size
        in_blocks = blocks(*shape)
        self.features = np.concatenate([self.model.encode(self.images[block]) for block in in_blocks])
        self.reconstructions = np.concatenate([grey(self.model.decode(self.features[block])) for block in in_blocks])
        errors = image_errors(self.model.arrays, self.images.reshape(shape), self.reconstructions.reshape(shape))
        self.variation = errors.variation
        bag, segment = (np.repeat(np.arange(len(sizes)), sizes) for sizes in (self.bags["frames"], segment_sizes))
        self.frames = dict(bag=bag, segment=segment, time_s=times, **numbered("u", self.torques.T),
                           **numbered("z", self.features.T), mean_rms=errors.mean_rms, pca_rms=errors.pca_rms,
                           reconstruction_rms=errors.reconstruction_rms)
        self.spectrum = {"component": np.arange(1, len(errors.share) + 1),
                         "variance": self.model.arrays["pca_variance"], "share": errors.share}
        self.tables.update({"features.csv": self.frames, "spectrum.csv": self.spectrum})

    def _predict(self, segment_sizes, steps, say):
        order = self.model.options["order"]
        steps = max(0, min(steps, np.max(segment_sizes) - order))  # shorter if no segment is long enough
        starts, errors = prediction_starts(segment_sizes, order, steps), np.zeros((3, 0))
        if steps > 0:
            say("predicting %d step(s) from %d frames" % (steps, len(starts)))
            predicted, blind = (predicted_features(self.model, self.features, self.torques, starts, steps, told)
                                for told in (None, self.torques.mean(axis=0)))
            errors = prediction_errors(self.model, self.images, starts, predicted, blind)
            self._choose_predictions(starts, predicted)
        self.errors = dict(zip(("steps", "num_predictions", "rmse", "rmse_repeat", "rmse_mean_torque"),
                               (np.arange(1, steps + 1), np.full(steps, len(starts)), *errors)))
        self.tables["prediction_errors.csv"] = self.errors

    def _choose_predictions(self, starts, predicted):
        """Chooses two rollouts for the report, ranked by the distance between the last predicted feature and the
        feature of the recorded image: the median and the worst."""
        steps = np.arange(predicted.shape[1])
        ranked = np.argsort(np.linalg.norm(predicted[:, -1] - self.features[starts + steps[-1]], axis=1), kind="stable")
        shown = {"typical": ranked[len(ranked) // 2], "worst": ranked[-1]}
        self.predictions = {kind: Prediction(starts[i], predicted[i], grey(self.model.decode(predicted[i])))
                            for kind, i in shown.items()}
        self.tables["predicted_features.csv"] = dict(
            kind=np.repeat(list(shown), len(steps)), frame=np.repeat(starts[list(shown.values())], len(steps)),
            steps=np.tile(steps, len(shown)), **numbered("z", np.concatenate(predicted[list(shown.values())]).T))

    @property
    def max_torque(self):
        """Torque limit of each motor [N m]."""
        return np.broadcast_to(self.model.options["max_torque"], (self.model.torque_dim,))

    def decode_plane(self, features):
        """Decodes features with given first two components [N x 2]. All other components are those of the goal feature,
        or 0 without a goal."""
        goal = self.model.goal_feature
        if goal is None:
            goal = np.zeros(self.model.options["feature_dim"])
        return grey(self.model.decode(np.column_stack([features, np.tile(goal[2:], (len(features), 1))])))
