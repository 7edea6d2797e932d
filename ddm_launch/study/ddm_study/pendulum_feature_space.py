# Draws the pendulum's feature space: decoded images, experience so far, current frame, goal and plan.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.command import Failure
from ddm_launch.figure_style import (COLUMN_WIDTH, GREEN, SKY, VERMILLION, YELLOW, add_legend, new_figure,
                                     panel_above_legend, save)
from ddm_launch.images import Decoder
from ddm_launch.tables import grouped, optional, read_csv
from ddm_model.feature_grid import GRID, FeatureGrid

# kind: marker, size [pt^2], colour, label, in the order of drawing. The colours are those of the paper's figure.
KINDS = {"experience": ("o", 6, GREEN, "experience"),
         "goal": ("*", 190, VERMILLION, "goal"),
         "plan": ("^", 14, YELLOW, "plan"),
         "current": ("s", 32, SKY, "current")}
ABOUT = ("The feature space of one moment, as feature_space wrote it. %d x %d decoded images over [-1, 1] x [-1, 1], the "
         "features of all frames so far, the current one, the goal's, and the planned ones. The axes reach beyond the "
         "images where a feature does." % (GRID, GRID))
OUTSIDE = "#333333"  # where there are features and no images


def read_space(path):
    """The features of a file of feature_space, as {kind: list of (z_1, z_2)}, the plan in order of its steps."""
    rows = read_csv(path, {"kind": str, "step": optional(int), "z_1": float, "z_2": float},
                    "rosrun ddm_launch feature_space writes it")
    space = grouped(path, rows, "kind", KINDS)
    missing = [kind for kind in KINDS if not space[kind]]
    if missing:
        raise Failure("%s has no row of kind %s: was it written by feature_space?" % (path, ", ".join(missing)))
    space["plan"].sort(key=lambda row: row["step"])
    return {kind: [(row["z_1"], row["z_2"]) for row in of_kind] for kind, of_kind in space.items()}


def draw_space(axes, space, decoder):
    """The grid over [-1, 1]^2 as in the paper; the axes reach further where a feature lies outside."""
    grid = FeatureGrid((-1.0, -1.0), (1.0, 1.0))
    grid.draw(axes, decoder.decode(grid.features))
    for order, (kind, (marker, size, colour, label)) in enumerate(KINDS.items()):
        if kind == "plan":
            label = "plan, %d steps" % len(space[kind])
            axes.plot(*zip(*(space["current"][-1:] + space["plan"])), color=YELLOW, linewidth=0.8, zorder=3 + order)
        axes.scatter(*zip(*space[kind]), marker=marker, s=size, color=colour, edgecolors="black",
                     linewidths=0.25 if kind == "experience" else 0.6, label=label, zorder=3 + order)
    axes.set_facecolor(OUTSIDE)
    left, right, bottom, top = grid.extent
    reach = max(abs(value) for points in space.values() for point in points for value in point) + 0.06
    axes.set_xlim(min(left, -reach), max(right, reach))
    axes.set_ylim(min(bottom, -reach), max(top, reach))


def add_arguments(parser):
    parser.add_argument("file", metavar="FILE.csv", help="what feature_space has written")
    parser.add_argument("--model", metavar="MODEL.ddm", required=True, help="the model of that trial")


def draw(options):
    space = read_space(options.file)
    with new_figure(COLUMN_WIDTH, COLUMN_WIDTH + 0.05) as figure:
        axes, place = panel_above_legend(figure)
        draw_space(axes, space, Decoder(options.model))
        add_legend(figure, place, *axes.get_legend_handles_labels(), ncol=4, columnspacing=1.0, handletextpad=0.2)
        save(figure, options.out)
