# Draws the figures of a report.
# SPDX-License-Identifier: BSD-3-Clause
import base64
import io
import os

import matplotlib
matplotlib.use("Agg")  # draws without a display
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402
import numpy as np  # noqa: E402

from ddm_model.feature_grid import FeatureGrid  # noqa: E402
from ddm_model.model import preprocessed  # noqa: E402
from ddm_model.model_data import kept_by_pca  # noqa: E402

# Colours of the Okabe-Ito set, which colour-blind readers can distinguish. Dashes and shapes differ, too.
BLUE, VERMILLION, YELLOW, GREY, LIGHT = "#0072B2", "#D55E00", "#F0E442", "#666666", "#dddddd"
WIDTH = 9.0  # [in]
MAX_COLUMNS = 16  # largest number of images side by side
RECONSTRUCTIONS = 8
MAX_HEIGHT = 30.0  # [in], that of about 100 bags


def as_data_uri(figure):
    """PNG of a figure as a data URI for <img>. Closes the figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=110)
    plt.close(figure)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def new_axes(height, columns=1, rows=1):
    figure, axes = plt.subplots(rows, columns, figsize=(WIDTH, height), constrained_layout=True, squeeze=False)
    for one in axes.flat:
        one.grid(True, color=LIGHT, linewidth=0.6)
        one.set_axisbelow(True)
    return figure, axes.ravel()


def draw_spectrum(data):
    """Draws the variance along each principal component and, if there are bags, the share of their images that the
    components keep."""
    figure, axes = new_axes(3.0, columns=1 if data.spectrum is None else 2)
    variance = data.model.arrays["pca_variance"]
    axes[0].semilogy(np.arange(1, len(variance) + 1), variance, color=BLUE, marker="o", markersize=3)
    axes[0].set(xlabel="principal component", ylabel="variance [grey²]", title="images learned from")
    if data.spectrum is not None:
        share = 100.0 * np.cumsum(data.spectrum["share"])
        axes[1].plot(data.spectrum["component"], share, color=VERMILLION, marker="o", markersize=3)
        axes[1].set(ylim=(0.0, 103.0), xlabel="principal components kept", ylabel="of these bags' images [%]",
                    title="images of these bags")
    return figure


def draw_rows(rows, labels, columns):
    """Draws rows of grey images side by side. labels: text at the left of each row. columns: text above each column."""
    size = len(rows[0][0])
    figure, axes = plt.subplots(figsize=(WIDTH, WIDTH / max(len(columns), 6) * len(rows) * 1.12), constrained_layout=True)
    axes.imshow(np.vstack([np.hstack(list(row)) for row in rows]), cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    for axis, texts in ((axes.xaxis, columns), (axes.yaxis, labels)):
        axis.set_ticks(size * (np.arange(len(texts)) + 0.5) - 0.5)
        axis.set_ticklabels(texts, fontsize=9)
        axis.set_ticks(size * np.arange(1, len(texts)) - 0.5, minor=True)
        axis.set_tick_params(which="both", length=0)
    axes.xaxis.tick_top()
    axes.grid(True, which="minor", color="white", linewidth=2.0)
    return figure


def draw_reconstructions(data):
    """Draws some images, their projections on the principal components, and their reconstructions."""
    shown = np.unique(np.arange(RECONSTRUCTIONS) * len(data.images) // RECONSTRUCTIONS)
    images = data.images[shown]
    y = preprocessed(data.model.arrays, images.reshape(len(shown), -1) / 255.0)
    kept = kept_by_pca(data.model.arrays, y)[1].reshape(images.shape)
    return draw_rows([images, 255.0 * kept, data.reconstructions[shown]], ["image", "PCA", "features"],
                     ["frame %d" % frame for frame in shown])


def draw_prediction(data, prediction):
    """Draws recorded images, predicted images and the last frame repeated, from 0 steps ahead on."""
    steps = len(prediction.images)
    shown = np.unique(np.linspace(0, steps - 1, min(steps, MAX_COLUMNS)).round().astype(int))
    return draw_rows([data.images[prediction.frame + shown], prediction.images[shown],
                      data.images[prediction.frame + 0 * shown]],
                     ["truth", "predicted", "repeated"], ["%d" % k for k in shown])


def draw_errors(data):
    """Draws the errors of rollouts over the number of steps ahead."""
    figure, (axes,) = new_axes(3.4)
    steps = data.errors["steps"]
    for column, colour, style, label in (
            ("rmse", BLUE, "o-", "predicted"), ("rmse_repeat", GREY, "s--", "last frame repeated"),
            ("rmse_mean_torque", VERMILLION, "^:", "predicted without knowing the torques")):
        axes.plot(steps, data.errors[column], style, color=colour, markersize=4, label=label)
    axes.set(ylim=(0.0, None), xlabel="steps ahead", ylabel="error of a pixel, rms [grey]")
    axes.legend()
    return figure


def plane_range(data):
    """(low, high): ranges of the first two features over all frames, with a margin. Without bags, [-1, 1] as in the
    paper."""
    if data.features is None:
        return np.full(2, -1.0), np.full(2, 1.0)
    features = data.features[:, :2]
    margin = np.maximum(0.05 * np.ptp(features, axis=0), 0.02)  # at least 0.02, in case all features are equal
    return features.min(axis=0) - margin, features.max(axis=0) + margin


def draw_plane(data):
    """Draws decoded images over the range of the features, and the features of all frames."""
    low, high = plane_range(data)
    figure, axes = plt.subplots(figsize=(WIDTH, 6.2), constrained_layout=True)
    grid = FeatureGrid(low, high)
    grid.draw(axes, data.decode_plane(grid.features))
    if data.features is not None:
        axes.scatter(data.features[:, 0], data.features[:, 1], s=9, color=YELLOW, edgecolors="black",
                     linewidths=0.25, label="frames of these bags", zorder=2)
    if data.model.goal_feature is not None:
        axes.scatter(*data.model.goal_feature[:2], marker="*", s=190, color=VERMILLION, edgecolors="black", linewidths=0.6,
                     label="goal", zorder=3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))  # beside the images
    return figure


def draw_pairing(data):
    """Draws the times of frames, and of images and torques without a partner. Each bag has a row."""
    paths = [os.path.abspath(path) for path in data.bags["bag"]]
    folder = os.path.commonpath([os.path.dirname(path) for path in paths])
    names = [os.path.relpath(path, folder) for path in paths]  # bags of trials differ only in their folders
    figure, (axes,) = new_axes(min(0.9 + 0.3 * len(names), MAX_HEIGHT))
    kinds = {"frames": (data.frames["bag"], data.frames["time_s"]), **data.unpaired}
    for (label, (bags, times)), colour, shift in zip(kinds.items(), (GREY, VERMILLION, BLUE), (0.0, -0.3, 0.3)):
        axes.plot(times, bags + shift, "|", color=colour, markersize=5, label="%s: %d" % (label, len(bags)))
    axes.set(yticks=np.arange(len(names)), yticklabels=names, ylim=(len(names) - 0.4, -0.6),
             xlabel="time since the bag's first frame [s]")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=3, frameon=False)
    return figure


def draw_coverage(data):
    """Draws histograms of each feature and each torque."""
    series = [("feature $z_{%d}$" % (i + 1), column, None) for i, column in enumerate(data.features.T)]
    series += [("torque $u_{%d}$ [N m]" % (i + 1), column, limit)
               for i, (column, limit) in enumerate(zip(data.torques.T, data.max_torque))]
    columns, rows = min(6, len(series)), (len(series) + 5) // 6
    figure, axes = new_axes(min(2.6 * rows, MAX_HEIGHT), columns, rows)
    for one in axes[len(series):]:
        one.remove()
    for one, (label, values, limit) in zip(axes, series):
        one.hist(values, bins=30, color=BLUE)
        one.yaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))
        one.set_xlabel(label)
        for line in () if limit is None else (-limit, limit):
            one.axvline(line, color=GREY, linestyle="--")
    for one in axes[::columns]:
        one.set_ylabel("frames")
    return figure
