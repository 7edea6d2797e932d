# Draws the feature plane of one model or of several side by side: decoded images, and where the frames lie.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os

from ddm_launch.figure_style import COLUMN_WIDTH, PAGE_WIDTH, VERMILLION, YELLOW, new_figure, save, write
from ddm_launch.images import Decoder
from ddm_launch.prediction_strip import REMEDY
from ddm_launch.run_folder import RunFolderError, number, read_csv, read_setting
from ddm_model.feature_grid import GRID, FeatureGrid

SETS = (("training", "o", VERMILLION, "training frames"), ("held_out", "^", YELLOW, "held-out frames"))


def read_features(folder):
    """The features of all frames of FOLDER/features.csv, as {set: list of (z_1, z_2)}."""
    path = os.path.join(folder, "features.csv")
    features = {name: [] for name, _, _, _ in SETS}
    for row in read_csv(path, ["set", "z_1", "z_2"], REMEDY):
        if "z_3" in row:
            raise RunFolderError("%s has features of more than two numbers: a plane shows two" % path)
        if row["set"] not in features:
            raise RunFolderError("%s: column set must be training or held_out, got '%s'" % (path, row["set"]))
        features[row["set"]].append((number(row, "z_1", path), number(row, "z_2", path)))
    return features


def grid_around(points):
    """The grid over all these features, with a margin of a twentieth of their range.

    Raises RunFolderError if they lie on a line along an axis: then there is no plane to draw.
    """
    low, high = [min(values) for values in zip(*points)], [max(values) for values in zip(*points)]
    if not all(b - a > 1e-9 for a, b in zip(low, high)):
        raise RunFolderError("the features cover [%g, %g] x [%g, %g], which is no plane" % (
            low[0], high[0], low[1], high[1]))
    margin = [0.05 * (b - a) for a, b in zip(low, high)]
    return FeatureGrid([a - m for a, m in zip(low, margin)], [b + m for b, m in zip(high, margin)])


def draw_plane(axes, features, decoder):
    """Decoded images over the range of the features, and the features of both sets on top."""
    grid_around([point for points in features.values() for point in points]).draw(axes, decoder)
    for name, marker, colour, label in SETS:
        if features[name]:
            axes.scatter(*zip(*features[name]), marker=marker, s=7, color=colour, edgecolors="black", linewidths=0.25,
                         label=label, zorder=2)


def draw(folders, out, make_decoder=Decoder):
    """Draws one panel per folder of prediction_experiment into a picture file."""
    panels = [(read_setting(folder, "training", "schedule", "training schedule"), read_features(folder),
               make_decoder(os.path.join(folder, "model.ddm"))) for folder in folders]
    width = COLUMN_WIDTH if len(panels) == 1 else PAGE_WIDTH
    with new_figure(width, width / len(panels) + 0.35) as figure:
        grid = figure.add_gridspec(2, len(panels), height_ratios=[1.0, 0.001])
        for column, (schedule, features, decoder) in enumerate(panels):
            axes = figure.add_subplot(grid[0, column])
            draw_plane(axes, features, decoder)
            axes.set_title(schedule.replace("_", " "))
        handles, labels = axes.get_legend_handles_labels()
        legend = figure.add_subplot(grid[1, :])
        legend.axis("off")
        legend.legend(handles, labels, loc="center", ncol=2, markerscale=2.0, frameon=False)
        save(figure, out)


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="feature_plane",
        description="Draws for each folder of prediction_experiment the plane of its features: %d x %d images that the "
        "model decodes, over the smallest rectangle that holds the features of all frames and a margin, and on them "
        "the features of training and held-out frames. Each panel is named by its training schedule." % (GRID, GRID))
    parser.add_argument("folders", metavar="DIR", nargs="+", help="folder of prediction_experiment")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("feature_plane", options.out, lambda out: draw(options.folders, out))
