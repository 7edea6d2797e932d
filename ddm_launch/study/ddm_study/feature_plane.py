# Draws the feature plane of one model or of several side by side: decoded images, and where the frames lie.
# SPDX-License-Identifier: BSD-3-Clause
import os

import numpy as np

from ddm_launch.command import Failure
from ddm_launch.figure_style import COLUMN_WIDTH, PAGE_WIDTH, VERMILLION, YELLOW, add_legend, new_figure, save
from ddm_launch.images import Decoder
from ddm_launch.run_folder import read_setting
from ddm_launch.tables import grouped, read_csv
from ddm_model.feature_grid import GRID, FeatureGrid
from ddm_study.prediction_strip import REMEDY

ABOUT = ("The plane of features of folders of prediction_experiment, side by side. %d x %d images that the model decodes, "
         "over the smallest rectangle that holds the features of all frames and a margin, and on them the features of "
         "training and held-out frames." % (GRID, GRID))
SETS = (("training", "o", VERMILLION, "training frames"), ("held_out", "^", YELLOW, "held-out frames"))


def read_features(folder):
    """The features of all frames of FOLDER/features.csv, as {set: list of (z_1, z_2)}."""
    path = os.path.join(folder, "features.csv")
    rows = read_csv(path, {"set": str, "z_1": float, "z_2": float}, REMEDY)
    if "z_3" in rows[0]:
        raise Failure("%s has features of more than two numbers: a plane shows two" % path)
    groups = grouped(path, rows, "set", [name for name, _, _, _ in SETS])
    return {name: [(row["z_1"], row["z_2"]) for row in of_set] for name, of_set in groups.items()}


def grid_around(points):
    """The grid over all these features, with a margin of a twentieth of their range.

    Raises Failure if they lie on a line along an axis: then there is no plane to draw.
    """
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    if not np.all(high - low > 1e-9):
        raise Failure("the features cover [%g, %g] x [%g, %g], which is not a plane" % (
            low[0], high[0], low[1], high[1]))
    margin = 0.05 * (high - low)
    return FeatureGrid(low - margin, high + margin)


def draw_plane(axes, features, decoder):
    """Decoded images over the range of the features, and the features of both sets on top."""
    grid = grid_around([point for points in features.values() for point in points])
    grid.draw(axes, decoder.decode(grid.features))
    for name, marker, colour, label in SETS:
        if features[name]:
            axes.scatter(*zip(*features[name]), marker=marker, s=7, color=colour, edgecolors="black", linewidths=0.25,
                         label=label, zorder=2)


def add_arguments(parser):
    parser.add_argument("folders", metavar="DIR", nargs="+", help="folder of prediction_experiment")


def draw(options):
    """One panel per folder, named by its training schedule."""
    panels = [(read_setting(folder, "training", "schedule", "training schedule"), read_features(folder),
               Decoder(os.path.join(folder, "model.ddm"))) for folder in options.folders]
    width = COLUMN_WIDTH if len(panels) == 1 else PAGE_WIDTH
    with new_figure(width, width / len(panels) + 0.35) as figure:
        grid = figure.add_gridspec(2, len(panels), height_ratios=[1.0, 0.001])
        for column, (schedule, features, decoder) in enumerate(panels):
            axes = figure.add_subplot(grid[0, column])
            draw_plane(axes, features, decoder)
            axes.set_title(schedule.replace("_", " "))
        add_legend(figure, grid[1, :], *axes.get_legend_handles_labels(), ncol=2, markerscale=2.0)
        save(figure, options.out)
