# Draws features and decoded images: feature planes, predicted images, and the pendulum's plan in feature space.
# SPDX-License-Identifier: BSD-3-Clause
import os

import numpy as np

from ddm_launch.figure_style import (COLUMN_WIDTH, GREEN, PAGE_WIDTH, SKY, VERMILLION, YELLOW, Figure, add_legend, argument,
                                     labelled, new_figure, panel_above_legend, save, show_image)
from ddm_launch.plant import draw_images
from ddm_model.feature_grid import GRID, FeatureGrid
from ddm_model.model import load
from ddm_model.model_data import grey
from ddm_study.results import read_table

SETS = {"training": ("o", VERMILLION, "training frames"), "held_out": ("^", YELLOW, "held-out frames")}
# kind: marker, size [pt^2] and colour, in the order of drawing. The colours are those of the paper's figure.
KINDS = {"experience": ("o", 6, GREEN), "goal": ("*", 190, VERMILLION), "plan": ("^", 14, YELLOW), "current": ("s", 32, SKY)}
OUTSIDE = "#333333"  # colour of the area around the decoded images


def decode(path, features):
    """Decodes features with a model file. Returns one grey image per feature."""
    return grey(load(path).decode(features))


def draw_plane(options):
    width = COLUMN_WIDTH if len(options.folders) == 1 else PAGE_WIDTH
    with new_figure(width, width / len(options.folders) + 0.35) as figure:
        grid = figure.add_gridspec(2, len(options.folders), height_ratios=[1.0, 0.001])
        for column, (title, folder) in enumerate(options.folders):
            axes, features = figure.add_subplot(grid[0, column]), read_table(folder, "features.csv")
            points = features[["z_1", "z_2"]].to_numpy()
            margin = 0.05 * np.ptp(points, axis=0)
            plane = FeatureGrid(points.min(axis=0) - margin, points.max(axis=0) + margin)
            plane.draw(axes, decode(os.path.join(folder, "model.ddm"), plane.features))
            for name, (marker, colour, label) in SETS.items():
                rows = features[features.set == name]
                axes.scatter(rows.z_1, rows.z_2, marker=marker, s=7, color=colour, edgecolors="black", linewidths=0.25,
                             label=label, zorder=2)
            axes.set_title(title)
        add_legend(figure, grid[1, :], *axes.get_legend_handles_labels(), ncol=2, markerscale=2.0)
        save(figure, options.out)


def draw_strip(options):
    strip = read_table(options.folder, "strip.csv")
    features = [name for name in strip if name.startswith("z_")]
    states = strip.drop(columns=features + ["steps"])
    images = (("true", [draw_images(options.folder, state).images[0] for state in states.values]),
              ("predicted", decode(os.path.join(options.folder, "model.ddm"), strip[features].values)))
    with new_figure(PAGE_WIDTH, 1.85) as figure:
        axes = figure.subplots(2, len(strip))
        for of_row, (label, of_label) in zip(axes, images):
            of_row[0].set_ylabel(label, labelpad=3)
            for one, image in zip(of_row, of_label):
                show_image(one, image, interpolation="nearest")
        for one, steps in zip(axes[0], strip.steps):
            one.set_title("+%d" % steps if steps else "now", pad=3)
        axes[1][len(strip) // 2].set_xlabel("steps ahead")
        save(figure, options.out)


def draw_space(options):
    """Draws the grid over [-1, 1]^2 as in the paper. The axes extend further if a feature lies outside."""
    space = read_table(options.file)
    grid = FeatureGrid((-1.0, -1.0), (1.0, 1.0))
    with new_figure(COLUMN_WIDTH, COLUMN_WIDTH + 0.05) as figure:
        axes, place = panel_above_legend(figure)
        grid.draw(axes, decode(options.model, grid.features))
        way = space[space.kind.isin(["current", "plan"])].sort_values("step")
        axes.plot(way.z_1, way.z_2, color=YELLOW, linewidth=0.8, zorder=5)
        for order, (kind, (marker, size, colour)) in enumerate(KINDS.items()):
            points = space[space.kind == kind]
            axes.scatter(points.z_1, points.z_2, marker=marker, s=size, color=colour, edgecolors="black",
                         linewidths=0.25 if kind == "experience" else 0.6, zorder=3 + order,
                         label="plan, %d steps" % len(points) if kind == "plan" else kind)
        axes.set_facecolor(OUTSIDE)
        left, right, bottom, top = grid.extent
        reach = space[["z_1", "z_2"]].abs().values.max() + 0.06
        axes.set_xlim(min(left, -reach), max(right, reach))
        axes.set_ylim(min(bottom, -reach), max(top, reach))
        add_legend(figure, place, *axes.get_legend_handles_labels(), ncol=4, columnspacing=1.0, handletextpad=0.2)
        save(figure, options.out)


PLANE = Figure(
    "The plane of features of folders of prediction_experiment, side by side. %d x %d images that the model decodes, over "
    "the smallest rectangle that holds the features of all frames and a margin, and on them the features of training and "
    "held-out frames." % (GRID, GRID),
    [argument("folders", metavar="LABEL=DIR", nargs="+", type=labelled, help="folder of prediction_experiment")], draw_plane)
STRIP = Figure(
    "True images, and the model's long-term predictions of the same frames below. The column 'now' is the frame from which "
    "the model predicts; below it is its reconstruction.",
    [argument("folder", metavar="DIR", help="folder of prediction_experiment")], draw_strip)
SPACE = Figure(
    "The feature space of one moment, as feature_space wrote it. %d x %d decoded images over [-1, 1] x [-1, 1], the "
    "features of all frames so far, the current one, the goal's, and the planned ones. The axes reach beyond the images "
    "where a feature does." % (GRID, GRID),
    [argument("file", metavar="FILE.csv", help="what feature_space has written"),
     argument("--model", metavar="MODEL.ddm", required=True, help="the model of that trial")], draw_space)
