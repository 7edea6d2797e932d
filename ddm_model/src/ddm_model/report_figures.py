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
from ddm_model.model import blurred  # noqa: E402
from ddm_model.model_data import kept_by_pca  # noqa: E402

# Colours of the Okabe-Ito set, which colour-blind readers can distinguish. Dashes and shapes differ, too.
BLUE, VERMILLION, YELLOW, GREY, LIGHT = "#0072B2", "#D55E00", "#F0E442", "#666666", "#dddddd"
WIDTH = 9.0  # [in]
MAX_COLUMNS = 16  # largest number of images side by side
RECONSTRUCTIONS = 8
BAGS = 20


def as_data_uri(figure):
    """PNG of a figure as a data URI for <img>. Closes the figure."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=110)
    plt.close(figure)
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode("ascii")


def new_axes(height, columns=1):
    figure, axes = plt.subplots(1, columns, figsize=(WIDTH, height), constrained_layout=True, squeeze=False)
    for one in axes[0]:
        one.grid(True, color=LIGHT, linewidth=0.6)
        one.set_axisbelow(True)
    return figure, axes[0]


def draw_spectrum(data):
    """Draws the variance along each principal component and, if there are bags, the share of their images that the
    components keep."""
    figure, axes = new_axes(3.0, columns=1 if data.spectrum is None else 2)
    variance = data.model.arrays["pca_variance"]
    axes[0].semilogy(np.arange(1, len(variance) + 1), variance, color=BLUE, marker="o", markersize=3)
    axes[0].set_xlabel("principal component")
    axes[0].set_ylabel("variance [grey²]")
    axes[0].set_title("images learned from")
    if data.spectrum is not None:
        share = 100.0 * np.cumsum(data.spectrum["share"])
        axes[1].plot(data.spectrum["component"], share, color=VERMILLION, marker="o", markersize=3)
        axes[1].set_ylim(0.0, 103.0)
        axes[1].set_xlabel("principal components kept")
        axes[1].set_ylabel("of these bags' images [%]")
        axes[1].set_title("images of these bags")
    return figure


def draw_rows(rows, labels, columns):
    """Draws rows of grey images. labels: text at the left of each row. columns: text above each column."""
    shape = (len(rows), len(columns))
    figure, axes = plt.subplots(*shape, figsize=(WIDTH, WIDTH / max(len(columns), 6) * len(rows) * 1.12), squeeze=False)
    for i, (row, label) in enumerate(zip(rows, labels)):
        for j, picture in enumerate(row):
            axes[i, j].imshow(picture, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
            axes[i, j].set_xticks([])
            axes[i, j].set_yticks([])
            if i == 0:
                axes[i, j].set_title(columns[j], fontsize=9)
        axes[i, 0].set_ylabel(label, fontsize=9, rotation=0, ha="right", va="center")
    figure.tight_layout(pad=0.3)  # constrained layout takes minutes for so many axes in matplotlib 3.3
    return figure


def draw_reconstructions(data):
    """Draws some images, their projections on the principal components, and their reconstructions."""
    shown = np.unique(np.arange(RECONSTRUCTIONS) * len(data.images) // RECONSTRUCTIONS)
    images = data.images[shown]
    y = blurred(data.model.arrays, images.reshape(len(shown), -1) / 255.0)
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
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("steps ahead")
    axes.set_ylabel("error of a pixel, rms [grey]")
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
    if data.goal_feature is not None:
        axes.scatter(*data.goal_feature[:2], marker="*", s=190, color=VERMILLION, edgecolors="black", linewidths=0.6,
                     label="goal", zorder=3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0))  # beside the images
    return figure


def draw_pairing(data):
    """Draws the times of frames, and of images and torques without a partner. Each bag has a row. If there are more
    than BAGS bags, shows those with the most missing partners."""
    missing = sum(np.bincount(times[0].astype(int), minlength=len(data.bags["bag"])) for times in data.unpaired.values())
    bags = np.sort(np.argsort(-missing, kind="stable")[:BAGS])
    figure, (axes,) = new_axes(0.9 + 0.3 * len(bags))
    frames = data.frames["bag"], data.frames["time_s"]
    for (label, (numbers, times)), colour, shift in zip(
            [("frames", frames)] + list(data.unpaired.items()), (GREY, VERMILLION, BLUE), (0.0, -0.3, 0.3)):
        rows = np.searchsorted(bags, numbers)
        shown = np.isin(numbers, bags)
        axes.plot(times[shown], rows[shown] + shift, "|", color=colour, markersize=5,
                  label="%s: %d" % (label, len(numbers)))
    axes.set_yticks(np.arange(len(bags)))
    axes.set_yticklabels([os.path.basename(data.bags["bag"][bag]) for bag in bags])
    axes.set_ylim(len(bags) - 0.4, -0.6)
    axes.set_xlabel("time since the bag's first frame [s]")
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncol=3, frameon=False)
    return figure


def draw_coverage(data):
    """Draws histograms of each feature and each torque."""
    series = [("feature $z_{%d}$ [-]" % (i + 1), column, None) for i, column in enumerate(data.features.T)]
    series += [("torque $u_{%d}$ [N m]" % (i + 1), column, limit)
               for i, (column, limit) in enumerate(zip(data.torques.T, data.max_torque))]
    series = series[:6]
    figure, axes = new_axes(2.6, columns=len(series))
    for one, (label, values, limit) in zip(axes, series):
        one.hist(values, bins=30, color=BLUE)
        one.yaxis.set_major_locator(MaxNLocator(nbins=6, integer=True))
        one.set_xlabel(label)
        if limit is not None:
            one.axvline(-limit, color=GREY, linestyle="--")
            one.axvline(limit, color=GREY, linestyle="--")
    axes[0].set_ylabel("frames")
    return figure
