# Draws success rates over the frames learned from, next to the curves of the paper's Fig. 8.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import copy
import math
import statistics

from matplotlib.colors import to_rgb
from matplotlib.ticker import MaxNLocator

from ddm_launch.averages import success_rates, wilson_interval
from ddm_launch.command import Failure
from ddm_launch.figure_style import (BLACK, COLUMN_WIDTH, GREY, METHOD_STYLES, SKY, YELLOW, add_legend, new_figure,
                                     panel_above_legend, save)
from ddm_launch.run_folder import read_sweep
from ddm_launch.tables import read_csv

# The paper's methods: name; of the published curve: column of the rate, of its standard error (None: not given). A curve of
# ours of such a name is drawn in the same colour as the published one.
METHODS = (("DDM + MPC", "ddm_mpc", "ddm_mpc_se"),
           ("PILCO, state", "pilco_state", "pilco_state_se"),
           ("PILCO, features", "pilco_autoencoder_features", None),
           ("PILCO, PCA", "pilco_pca20_features", None))
# Colour, marker of the first, second, ... of our curves of a name that METHOD_STYLES does not have.
OTHERS = ((SKY, "h"), (YELLOW, "p"), (BLACK, "d"), (GREY, "x"))
OURS_LINE, PUBLISHED_LINE = "-", "--"
ABOUT = ("Success rate over the frames learned from. One curve per file of many seeds, with the standard error "
         "sqrt(p (1 - p) / (n - 1)); a level line where nothing is learned. Of more than five curves those that are 0 at most "
         "points are not drawn but told in words.")
LONGEST_PAIR = 54  # [characters] that fit next to each other into the width of a column
MOST_CURVES = 5  # that can be told apart; beyond that those that are mostly 0 are named only


class Curve:
    """Success rates over frames, of what a name says, with their standard errors or a band (lows, highs); both may be
    None: not known."""

    def __init__(self, name, remark, frames, rates, errors, band=None):
        self.name, self.label = name, "%s (%s)" % (name, remark)
        self.frames, self.rates, self.errors, self.band = frames, rates, errors, band

    def is_mostly_zero(self):
        return statistics.median(self.rates) == 0.0 and max(self.rates) < 0.5

    def in_words(self):
        """Label of a curve that is not drawn."""
        return self.label + (": mostly 0, at most %.2g" % max(self.rates) if max(self.rates) else ": 0")

    def spread_to(self, last_frames):
        """This curve; one that learns from no frames (the oracle) as a level line up to last_frames."""
        if self.frames != [0]:
            return self
        level = copy.copy(self)
        level.frames, level.rates, level.errors = [0, last_frames], 2 * self.rates, self.errors and 2 * self.errors
        level.band = self.band and [2 * edge for edge in self.band]
        return level


def read_curve(name, path, wilson=False):
    """The curve of a trials.csv or sweep.csv; the label names the number of its seeds.

    wilson: with 95 % intervals as a band instead of standard errors.
    """
    runs = read_sweep(path)
    rows = success_rates(runs.values())
    if not rows:
        raise Failure("%s: the success is not known in any row: there is nothing to draw" % path)
    frames, rates, errors, counts = map(list, zip(*rows))
    band = [list(edge) for edge in zip(*map(wilson_interval, rates, counts))] if wilson else None
    return Curve(name, "%d seed%s" % (len(runs), "" if len(runs) == 1 else "s"), frames, rates,
                 None if wilson else errors, band)


def read_published(path):
    """The paper's curves, in the order of METHODS."""
    columns = [name for method in METHODS for name in method[1:] if name]
    rows = read_csv(path, dict.fromkeys(["frames"] + columns, float),
                    "it is results/published/success_rate.csv of ddm_launch")
    frames, *series = ([row[name] for row in rows] if name else None
                       for name in ["frames"] + [name for method in METHODS for name in method[1:]])
    return [Curve(method[0], "paper", frames, rates, errors)
            for method, rates, errors in zip(METHODS, series[::2], series[1::2])]


def styles(names):
    """(colour, marker) of each curve. Raises Failure if some could not be distinguished."""
    of_name = dict(METHOD_STYLES)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise Failure("each curve must have a label of its own, got '%s' twice: give it another" % twice[0])
    others = [name for name in names if name not in of_name]
    if len(others) > len(OTHERS):
        raise Failure("at most %d curves besides those of known methods (%s) can be distinguished, got %d: draw two figures" % (
            len(OTHERS), "; ".join(of_name), len(others)))
    of_name.update(zip(others, OTHERS))
    return [of_name[name] for name in names]


def lighter(colour):
    """Half-way to white."""
    return tuple(0.5 + 0.5 * part for part in to_rgb(colour))


def draw_curves(axes, ours, published):
    """Ours with full lines and markers, on top of the paper's, which are dashed, open and lighter."""
    last_frames = max(100, *(curve.frames[-1] for curve in ours + published))
    looks = styles([curve.name for curve in ours]) + styles([curve.name for curve in published])
    crowded = len(looks) > MOST_CURVES
    named_only = [curve for curve in ours + published if crowded and curve.is_mostly_zero()]
    for curve, (colour, marker) in zip(ours + published, looks):
        if curve in named_only:
            continue
        if curve in published:
            axes.errorbar(curve.frames, curve.rates, yerr=curve.errors, color=lighter(colour), marker=marker,
                          linestyle=PUBLISHED_LINE, markerfacecolor="white", linewidth=0.9, capsize=2, elinewidth=0.7,
                          label=curve.label, zorder=2)
        else:
            level = curve.spread_to(last_frames)
            axes.errorbar(level.frames, level.rates, yerr=level.errors, color=colour, marker=marker, linestyle=OURS_LINE,
                          capsize=2, elinewidth=0.8, label=curve.label, zorder=3 if level is curve else 1)
            if level.band:
                axes.fill_between(level.frames, *level.band, color=colour, alpha=0.2, linewidth=0.0, zorder=1)
    for curve in named_only:
        axes.errorbar([], [], linestyle=" ", label=curve.in_words())
    axes.set_xlim(left=-40)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
    axes.set_ylim(-0.04, 1.04)
    axes.set_xlabel("frames learned from [image-torque pairs]")
    axes.set_ylabel("success rate [-]")
    axes.grid(True)


def num_legend_columns(ours, published):
    """2 where the longest two labels fit next to each other."""
    curves = ours + published
    crowded = len(curves) > MOST_CURVES
    lengths = sorted(len(curve.in_words() if crowded and curve.is_mostly_zero() else curve.label) for curve in curves)
    return 2 if sum(lengths[-2:]) <= LONGEST_PAIR else 1


def source(text):
    """LABEL=FILE.csv as (label, path)."""
    label, separator, path = text.partition("=")
    if not (label and separator and path):
        raise argparse.ArgumentTypeError("must be LABEL=FILE.csv, got '%s'" % text)
    return label, path


def add_arguments(parser):
    parser.add_argument("curves", metavar="LABEL=FILE.csv", nargs="+", type=source,
                        help="a label, and a trials.csv or sweep.csv; the labels %s have the colours of the paper's curves"
                        % "; ".join(method[0] for method in METHODS))
    parser.add_argument("--published", metavar="FILE.csv",
                        help="also draw the paper's curves: results/published/success_rate.csv of ddm_launch")
    parser.add_argument("--wilson", action="store_true",
                        help="draw Wilson's 95 %% intervals as bands instead of our standard errors, which are 0 where "
                        "all seeds succeed")


def draw_figure(figure, ours, published):
    """The curves, and below them the legend: ours, the paper's, and those that are not drawn."""
    axes, place = panel_above_legend(figure)
    draw_curves(axes, ours, published)
    add_legend(figure, place, *axes.get_legend_handles_labels(), ncol=num_legend_columns(ours, published),
               columnspacing=0.8, handlelength=2.2, handletextpad=0.5)


def draw(options):
    ours = [read_curve(label, path, options.wilson) for label, path in options.curves]
    published = read_published(options.published) if options.published else []
    num_rows = math.ceil(len(ours + published) / num_legend_columns(ours, published))
    with new_figure(COLUMN_WIDTH, 2.45 + 0.15 * num_rows) as figure:
        draw_figure(figure, ours, published)
        save(figure, options.out)
