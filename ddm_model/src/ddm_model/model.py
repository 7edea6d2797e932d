# Class Model: reads a model file and computes features, decoded images and predictions with NumPy.
# SPDX-License-Identifier: BSD-3-Clause
import os
import struct
import zlib

import numpy as np

MAGIC, HEADER = b"DDMMODEL", "<IQI"  # after MAGIC: version, size of the content [bytes], CRC-32
VERSION = 9  # version of the file format
MAX_GAIN = 4.0  # largest factor that changes the brightness of an image, as in pca.cpp


class ModelFileError(OSError, ValueError):
    """The file is not a model, or it is damaged. Derives from OSError, like all other failures to read a file."""


class _Reader:
    """Reads numbers in the order in which model_file.cpp writes them."""

    def __init__(self, content):
        self._content, self._at = content, 0

    def number(self, kind):
        """kind: a NumPy type with little-endian byte order, as in the file."""
        return self._take(kind, 1)[0]

    def array(self, kind):
        return self._take(kind, int(self.number("<u8")))

    def text(self):
        return self.array("u1").tobytes().decode("utf-8")

    def _take(self, kind, count):
        values = np.frombuffer(self._content, kind, count, self._at)
        self._at += values.nbytes
        return values


def _content(data):
    """Content of a model file after its header. Raises ModelFileError if header, size or checksum are wrong. With the
    right checksum, the content is as model_file.cpp has checked and written it."""
    begin = len(MAGIC) + struct.calcsize(HEADER)
    if data[:len(MAGIC)] != MAGIC:
        raise ModelFileError("is not a DDM model (it does not begin with %s)" % MAGIC.decode())
    if len(data) < begin:
        raise ModelFileError("is cut short: copy or train it again")
    version, size, checksum = struct.unpack_from(HEADER, data, len(MAGIC))
    if version != VERSION:
        raise ModelFileError("has format version %d, this program reads version %d: train it again from its bags"
                             % (version, VERSION))
    if size != len(data) - begin or checksum != zlib.crc32(data[begin:]):
        raise ModelFileError("is damaged (wrong size or checksum): copy or train it again")
    return data[begin:]


def _read_options(reader):
    """Reads the block `model` of the configuration."""
    options = {name: int(reader.number("<i4")) for name in ("pca_dim", "feature_dim", "order")}
    for name in ("encoder_widths", "decoder_widths", "predictor_widths"):
        options[name] = reader.array("<i4").tolist()
    options["max_torque"] = reader.array("<f8")
    options["blur"] = float(reader.number("<f8"))
    options["predictor"] = reader.text()
    return options


def _blur(size, std):
    """Weights of a Gaussian blur along one axis, one output pixel per row, in single precision like the model  [size x
    size].

    y_blurred = blur y blur^T for an image y. std: standard deviation of the Gaussian [pixels].
    """
    if not std > 0.0:
        return np.eye(size, dtype=np.float32)
    distance = np.subtract.outer(np.arange(size), np.arange(size)) / std
    weights = np.exp(-0.5 * distance ** 2)
    return (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32)


def _layers(theta, widths, name):
    """Splits parameters into ({NAME_W1: weights [outputs x inputs], NAME_b1: biases, ...}, remaining parameters)."""
    arrays = {}
    for layer, (inputs, outputs) in enumerate(zip(widths, widths[1:]), 1):
        weights, theta = np.split(theta, [inputs * outputs])
        arrays["%s_W%d" % (name, layer)] = weights.reshape(inputs, outputs).T  # stored column by column
        arrays["%s_b%d" % (name, layer)], theta = np.split(theta, [outputs])
    return arrays, theta


def preprocessed(arrays, y):
    """Gives images y the brightness and the blur that the model with these arrays gives them before it encodes them
    [N x D]."""
    if arrays["brightness"] > 0.0:
        with np.errstate(divide="ignore"):  # a black image gets the largest gain
            gain = arrays["brightness"] / np.sqrt(np.mean(np.square(y), axis=1, keepdims=True))
        y = np.minimum(MAX_GAIN, gain) * y
    blur, size = arrays["blur"], int(arrays["image_size"])
    if np.array_equal(blur, np.eye(size)):
        return y
    return (blur @ y.reshape(-1, size, size) @ blur.T).reshape(y.shape)


class Model:
    """A deep dynamical model (paper, eq. 3). Images, features and torques have one sample in each row.

    options: the block `model` of the configuration. num_features: number of features in the input of f. image_size: side
    of an image [pixels]. torque_dim: number of motors.
    info: id, seed, trial, frames (number of samples learned from), v_r, v_p, feature_spread, and config, the YAML text
    of the configuration that the model was trained with.
    arrays: all arrays that the model computes with, under the names in doc/reference/programs.md.
    goal_feature: z_ref, None without a goal image. support_states: features of the support states  [M x feature_dim].
    """

    def __init__(self, data):
        """data: content of a model file (bytes). Raises ModelFileError."""
        reader = _Reader(_content(data))
        self.options = _read_options(reader)
        n = self.options["order"]
        self.num_features = min(n, 2) if self.options["predictor"] == "gp" else n
        self.image_size, self.torque_dim = int(reader.number("<i4")), int(reader.number("<i4"))
        self.info = {"id": "%08x" % zlib.crc32(data)}
        for name, kind in (("seed", "<u8"), ("trial", "<u4"), ("frames", "<u4")):
            self.info[name] = int(reader.number(kind))
        for name in ("v_r", "v_p", "feature_spread"):
            self.info[name] = float(reader.number("<f8"))
        support_states = reader.array("<f4")
        self.info["config"] = reader.text()
        self.arrays = self._read_arrays(reader)
        dim = self.options["feature_dim"]
        self.support_states = support_states.reshape(-1, n * dim + (n - 1) * self.torque_dim)[:, :dim]
        goal = reader.array("u1")
        self.goal_feature = None
        if goal.size > 0:
            self.goal_feature = self.encode(goal[None])[0]
            self.arrays.update(goal=goal, goal_feature=self.goal_feature)

    def _read_arrays(self, reader):
        options = self.options
        max_torque = options["max_torque"]
        arrays = {"image_size": self.image_size, "torque_dim": self.torque_dim,
                  "feature_dim": options["feature_dim"], "order": options["order"],
                  "max_torque": max_torque[0] if max_torque.size == 1 else max_torque,
                  "blur": _blur(self.image_size, options["blur"]), "brightness": float(reader.number("<f4")),
                  "pca_scale": float(reader.number("<f4")),
                  "pca_mean": reader.array("<f4"), "pca_basis": reader.array("<f4"),
                  "pca_variance": reader.array("<f8")}
        arrays["pca_basis"] = arrays["pca_basis"].reshape(options["pca_dim"], -1).T
        theta, n, dim = reader.array("<f8"), options["order"], options["feature_dim"]
        networks = [("encoder", [options["pca_dim"], *options["encoder_widths"], dim]),
                    ("decoder", [dim, *options["decoder_widths"], options["pca_dim"]])]
        num_inputs = self.num_features * dim + n * self.torque_dim
        if options["predictor"] == "network":
            networks.append(("f", [num_inputs, *options["predictor_widths"], dim]))
        for name, widths in networks:
            layers, theta = _layers(theta, widths, name)
            arrays.update(layers)
        if options["predictor"] == "gp":
            sizes = np.cumsum([num_inputs, num_inputs * dim, dim])  # 1 / l, slope and bias
            num_centres = (theta.size - sizes[-1]) // (num_inputs + dim)
            inverse_scales, slope, bias, centres, weights = np.split(theta, [*sizes, sizes[-1] + num_inputs * num_centres])
            arrays.update(f_inverse_scales=inverse_scales, f_slope=slope.reshape(num_inputs, dim), f_bias=bias,
                          f_centres=centres.reshape(num_centres, num_inputs), f_weights=weights.reshape(num_centres, dim))
        return {name: np.asarray(value) for name, value in arrays.items()}

    def _network(self, name, a, last_linear=True):
        """Output of a fully connected network. a: inputs, one sample per row."""
        num_layers = sum(key.startswith(name + "_W") for key in self.arrays)
        for layer in range(1, num_layers + 1):
            a = a @ self.arrays["%s_W%d" % (name, layer)].T + self.arrays["%s_b%d" % (name, layer)]
            if layer < num_layers or not last_linear:
                a = np.arctan(a)
        return a

    def _gp(self, h):
        """Mean of the Gaussian process in f. h: inputs  [... x number of inputs]."""
        distances = (h * self.arrays["f_inverse_scales"])[..., None, :] - self.arrays["f_centres"]
        kernel = np.exp(-0.5 * np.sum(distances ** 2, axis=-1))
        return h @ self.arrays["f_slope"] + self.arrays["f_bias"] + kernel @ self.arrays["f_weights"]

    def encode(self, images):
        """Encoder: z = g^-1(y), eq. (3a).

        images: grey values 255 y  [N x size x size] or [N x size^2]. Returns features [N x feature_dim]. Raises
        ValueError if the number of pixels is wrong.
        """
        images = np.asarray(images)
        if images.size != len(images) * self.image_size ** 2:
            raise ValueError("images must have %d x %d pixels, got an array %s: crop and resize them" % (
                self.image_size, self.image_size, images.shape))
        y = preprocessed(self.arrays, images.reshape(len(images), -1) / 255.0)
        scores = self.arrays["pca_scale"] * ((y - self.arrays["pca_mean"]) @ self.arrays["pca_basis"])
        return self._network("encoder", scores, last_linear=False)

    def decode(self, features):
        """Decoder: y = g(z), eq. (3b). The result is not limited to [0, 1].

        features: [N x feature_dim]. Returns images [N x size x size].
        """
        scores = self._network("decoder", np.asarray(features)) / self.arrays["pca_scale"]
        y = self.arrays["pca_mean"] + scores @ self.arrays["pca_basis"].T
        return y.reshape(-1, self.image_size, self.image_size)

    def predict(self, features, torques):
        """Prediction model: z_{t+1} = f(z_t, u_t, ..., z_{t-n+1}, u_{t-n+1}), eq. (2). With model/predictor gp, features
        before z_{t-1} have no effect.

        features: z_{t-n+1} ... z_t, oldest first  [... x n x feature_dim]. torques: u_{t-n+1} ... u_t, oldest first
        [... x n x torque_dim, N m]. Returns z_{t+1}  [... x feature_dim]. Raises ValueError if the number of
        features or torques is wrong.
        """
        features, torques = np.asarray(features, dtype=float), np.asarray(torques, dtype=float)
        n = self.options["order"]
        if features.shape[-2] != n or torques.shape[-2] != n:
            raise ValueError("the last %d features and %d torques predict the next feature, got %d and %d" % (
                n, n, features.shape[-2], torques.shape[-2]))
        gp, last = self.options["predictor"] == "gp", features[..., -1, :]
        parts = []
        for lag in range(n):
            if lag < self.num_features:
                past = features[..., n - 1 - lag, :]
                parts.append(last - past if gp and lag > 0 else past)
            parts.append(torques[..., n - 1 - lag, :] / self.arrays["max_torque"])
        h = np.concatenate(parts, axis=-1)
        return last + self._gp(h) if gp else self._network("f", h)

    def roll_out(self, features, torques):
        """Rollout: predicts K features, each from the features before it.

        features: as for predict(). torques: as for predict(), followed by the later torques
        [... x n - 1 + K x torque_dim, N m]. Returns z_{t+1} ... z_{t+K}  [... x K x feature_dim].
        """
        n = self.options["order"]
        features, torques = np.asarray(features, dtype=float), np.asarray(torques, dtype=float)
        for k in range(torques.shape[-2] - n + 1):
            following = self.predict(features[..., -n:, :], torques[..., k:k + n, :])
            features = np.concatenate([features, following[..., None, :]], axis=-2)
        return features[..., n:, :]


def load(path):
    """Reads a Model from a file. Raises OSError, or ModelFileError with the name of the file."""
    if os.path.exists(path) and not os.path.isfile(path):  # reading a pipe or a device may never end
        raise OSError("cannot read %s: it is not a regular file" % path)
    with open(path, "rb") as stream:
        data = stream.read()
    try:
        return Model(data)
    except ModelFileError as error:
        raise ModelFileError("model %s: %s" % (path, error)) from None
