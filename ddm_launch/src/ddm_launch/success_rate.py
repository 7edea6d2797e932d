# Draws success rates over the frames learned from, beside the curves of the paper: its Fig. 8.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import math

from matplotlib.ticker import MaxNLocator

from ddm_launch.averages import success_rates
from ddm_launch.figure_style import (BLACK, BLUE, COLUMN_WIDTH, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION,
                                     new_figure, save, write)
from ddm_launch.run_folder import RunFolderError, number, read_csv, read_sweep

# Colour, marker, line of the first, second, ... of our curves.
OURS = ((BLUE, "o", "-"), (VERMILLION, "s", "--"), (GREEN, "^", "-."), (PURPLE, "X", ":"),
        (SKY, "v", (0, (5, 1, 1, 1, 1, 1))), (ORANGE, "P", (0, (1, 1))))
# Column of the rate, of its standard error (None: not given), colour, marker (drawn open), line, label.
PUBLISHED = (("ddm_mpc", "ddm_mpc_se", BLACK, "o", "--", "DDM + MPC (paper)"),
             ("pilco_state", "pilco_state_se", GREY, "s", "-.", "PILCO, true state (paper)"),
             ("pilco_autoencoder_features", None, GREY, "D", ":", "PILCO, 2-D features (paper)"),
             ("pilco_pca20_features", None, GREY, "x", ":", "PILCO, 20-D PCA (paper)"))


LONGEST_LABEL = 27  # [characters] that fit twice into the width of a column


class Curve:
    """Success rates and their standard errors (None: not known) over frames, and their label."""

    def __init__(self, label, frames, rates, errors):
        self.label, self.frames, self.rates, self.errors = label, frames, rates, errors

    def spread_to(self, last_frames):
        """This curve; one that learns from no frames (the oracle) as a level line up to last_frames."""
        if self.frames != [0]:
            return self
        return Curve(self.label, [0, last_frames], 2 * self.rates, 2 * self.errors)


def read_curve(label, path):
    """The curve of a trials.csv or sweep.csv; the number of its seeds stands in the label."""
    runs = read_sweep(path)
    rows = success_rates(runs.values())
    if not rows:
        raise RunFolderError("%s: the success is not known in any row: there is nothing to draw" % path)
    return Curve("%s (%d seed%s)" % (label, len(runs), "" if len(runs) == 1 else "s"),
                 [row[0] for row in rows], [row[1] for row in rows], [row[2] for row in rows])


def read_published(path):
    """The paper's curves, in the order of PUBLISHED."""
    columns = [name for curve in PUBLISHED for name in curve[:2] if name]
    rows = read_csv(path, ["frames"] + columns, "it is results/published/success_rate.csv of ddm_launch")

    def column(name):
        return [number(row, name, path) for row in rows]

    return [Curve(label, column("frames"), column(rate), column(error) if error else None)
            for rate, error, _, _, _, label in PUBLISHED]


def draw_curves(axes, ours, published):
    """Ours with full markers on top of the paper's with open ones."""
    last_frames = max(100, *(curve.frames[-1] for curve in ours + published))
    for curve, (colour, marker, line) in zip((curve.spread_to(last_frames) for curve in ours), OURS):
        axes.errorbar(curve.frames, curve.rates, yerr=curve.errors, color=colour, marker=marker, linestyle=line,
                      capsize=2, elinewidth=0.8, label=curve.label, zorder=3)
    for curve, (_, _, colour, marker, line, _) in zip(published, PUBLISHED):
        axes.errorbar(curve.frames, curve.rates, yerr=curve.errors, color=colour, marker=marker, linestyle=line,
                      markerfacecolor="white", linewidth=0.9, capsize=2, elinewidth=0.7, label=curve.label, zorder=2)
    axes.set_xlim(left=-40)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
    axes.set_ylim(-0.04, 1.04)
    axes.set_xlabel("frames learned from [image-torque pairs]")
    axes.set_ylabel("success rate [-]")
    axes.grid(True)


def num_legend_columns(curves):
    return 2 if all(len(curve.label) <= LONGEST_LABEL for curve in curves) else 1


def draw_figure(figure, ours, published):
    """The curves, and below them the legend."""
    grid = figure.add_gridspec(2, 1, height_ratios=[1.0, 0.001])
    axes = figure.add_subplot(grid[0])
    draw_curves(axes, ours, published)
    legend = figure.add_subplot(grid[1])
    legend.axis("off")
    legend.legend(*axes.get_legend_handles_labels(), loc="center", ncol=num_legend_columns(ours + published),
                  columnspacing=1.0, frameon=False, handlelength=2.6)


def draw(sources, published, out):
    """sources: (label, path) of each of our curves; published: path of the paper's, or None."""
    if len(sources) > len(OURS):
        raise RunFolderError("at most %d curves can be told apart, got %d: draw two figures" % (
            len(OURS), len(sources)))
    ours = [read_curve(label, path) for label, path in sources]
    paper = read_published(published) if published else []
    legend_rows = math.ceil(len(ours + paper) / num_legend_columns(ours + paper))
    with new_figure(COLUMN_WIDTH, 2.45 + 0.15 * legend_rows) as figure:
        draw_figure(figure, ours, paper)
        save(figure, out)


def source(text):
    """LABEL=FILE.csv as (label, path)."""
    label, separator, path = text.partition("=")
    if not (label and separator and path):
        raise argparse.ArgumentTypeError("must be LABEL=FILE.csv, got '%s'" % text)
    return label, path


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="success_rate",
        description="Draws the success rate of greedy evaluations and its standard error sqrt(p (1 - p) / (n - 1)) "
        "over the frames learned from, one curve per file of many seeds; a level line where nothing is learned.")
    parser.add_argument("curves", metavar="LABEL=FILE.csv", nargs="+", type=source,
                        help="a label, and a trials.csv or sweep.csv")
    parser.add_argument("--published", metavar="FILE.csv",
                        help="draw the paper's curves too: results/published/success_rate.csv of ddm_launch")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("success_rate", options.out, lambda out: draw(options.curves, options.published, out))
