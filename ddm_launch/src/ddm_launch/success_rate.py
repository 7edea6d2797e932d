# Draws success rates over the frames learned from, next to the curves of the paper's Fig. 8.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import collections
import math
import statistics

from matplotlib.colors import to_rgb
from matplotlib.ticker import MaxNLocator

from ddm_launch.averages import success_rates, wilson_interval
from ddm_launch.command import Failure
from ddm_launch.figure_style import (BLACK, COLUMN_WIDTH, GREY, METHOD_STYLES, SKY, YELLOW, Figure, add_legend, argument,
                                     new_figure, panel_above_legend, save)
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
LONGEST_PAIR = 54  # [characters] that fit next to each other into the width of a column
MOST_CURVES = 5  # that can be told apart; beyond that those that are mostly 0 are named only

# Success rates over frames of what a name says; lows and highs: ends of the error bars or of the band, or None: not known.
Curve = collections.namedtuple("Curve", "name label frames rates lows highs")


def read_curve(name, path, wilson=False):
    """The curve of a trials.csv or sweep.csv; the label names the number of its seeds. wilson: with 95 % intervals instead
    of standard errors."""
    runs = read_sweep(path)
    rows = success_rates(runs.values())
    if not rows:
        raise Failure("%s: the success is not known in any row: there is nothing to draw" % path)
    frames, rates, errors, counts = map(list, zip(*rows))
    ends = map(wilson_interval, rates, counts) if wilson else [(p - e, p + e) for p, e in zip(rates, errors)]
    label = "%s (%d seed%s)" % (name, len(runs), "" if len(runs) == 1 else "s")
    return Curve(name, label, frames, rates, *map(list, zip(*ends)))


def read_published(path):
    """The paper's curves, in the order of METHODS."""
    columns = [name for method in METHODS for name in method[1:] if name]
    rows = read_csv(path, dict.fromkeys(["frames"] + columns, float),
                    "it is results/published/success_rate.csv of ddm_launch")
    curves = []
    for name, rate, error in METHODS:
        lows, highs = ([row[rate] + sign * row[error] for row in rows] if error else None for sign in (-1.0, 1.0))
        curves.append(Curve(name, name + " (paper)", [row["frames"] for row in rows], [row[rate] for row in rows], lows,
                            highs))
    return curves


def styles(names):
    """(colour, marker) of each curve. Raises Failure if some could not be distinguished."""
    of_name = dict(METHOD_STYLES)
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise Failure("each curve must have a label of its own, got '%s' twice: give it another" % twice[0])
    others = [name for name in names if name not in of_name]
    if len(others) > len(OTHERS):
        raise Failure("at most %d curves besides those of known methods (%s) can be distinguished, got %d: draw two "
                      "figures" % (len(OTHERS), "; ".join(of_name), len(others)))
    of_name.update(zip(others, OTHERS))
    return [of_name[name] for name in names]


def is_mostly_zero(curve):
    return statistics.median(curve.rates) == 0.0 and max(curve.rates) < 0.5


def in_words(curve):
    """Label of a curve that is not drawn."""
    return curve.label + (": mostly 0, at most %.2g" % max(curve.rates) if max(curve.rates) else ": 0")


def level_line(curve, last_frames):
    """A curve that has learned from no frames (the oracle) reaches up to last_frames; others stay as they are."""
    return curve if curve.frames != [0] else curve._replace(
        frames=[0, last_frames], rates=2 * curve.rates, lows=2 * curve.lows, highs=2 * curve.highs)


def draw_curves(axes, ours, published, wilson):
    """Ours with full lines and markers, on top of the paper's, which are dashed, open and lighter. wilson: the ends of ours
    are the edges of a band."""
    last_frames = max(100, *(curve.frames[-1] for curve in ours + published))
    looks = styles([curve.name for curve in ours]) + styles([curve.name for curve in published])
    crowded = len(looks) > MOST_CURVES
    named_only = [curve for curve in ours + published if crowded and is_mostly_zero(curve)]
    for curve, (colour, marker) in zip(ours + published, looks):
        if curve in named_only:
            continue
        is_ours = curve in ours
        level = level_line(curve, last_frames)
        look = dict(color=colour, linestyle="-", elinewidth=0.8, zorder=3 if level is curve else 1)
        if not is_ours:
            look = dict(color=tuple(0.5 + 0.5 * part for part in to_rgb(colour)), linestyle="--", elinewidth=0.7,
                        markerfacecolor="white", linewidth=0.9, zorder=2)
        errors = None
        if is_ours and wilson:
            axes.fill_between(level.frames, level.lows, level.highs, color=colour, alpha=0.2, linewidth=0.0, zorder=1)
        elif level.lows:
            errors = [high - rate for rate, high in zip(level.rates, level.highs)]
        axes.errorbar(level.frames, level.rates, yerr=errors, marker=marker, capsize=2, label=curve.label, **look)
    for curve in named_only:
        axes.errorbar([], [], linestyle=" ", label=in_words(curve))
    axes.set_xlim(left=-40)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
    axes.set_ylim(-0.04, 1.04)
    axes.set_xlabel("frames learned from [image-torque pairs]")
    axes.set_ylabel("success rate [-]")
    axes.grid(True)


def source(text):
    """LABEL=FILE.csv as (label, path)."""
    label, separator, path = text.partition("=")
    if not (label and separator and path):
        raise argparse.ArgumentTypeError("must be LABEL=FILE.csv, got '%s'" % text)
    return label, path


def draw(options):
    ours = [read_curve(label, path, options.wilson) for label, path in options.curves]
    published = read_published(options.published) if options.published else []
    with new_figure(COLUMN_WIDTH, 2.45) as figure:
        axes, place = panel_above_legend(figure)
        draw_curves(axes, ours, published, options.wilson)
        handles, labels = axes.get_legend_handles_labels()
        num_columns = 2 if sum(sorted(map(len, labels))[-2:]) <= LONGEST_PAIR else 1
        figure.set_size_inches(COLUMN_WIDTH, 2.45 + 0.15 * math.ceil(len(labels) / num_columns))
        add_legend(figure, place, handles, labels, ncol=num_columns, columnspacing=0.8, handlelength=2.2,
                   handletextpad=0.5)
        save(figure, options.out)


FIGURE = Figure(
    "Success rate over the frames learned from. One curve per file of many seeds, with the standard error "
    "sqrt(p (1 - p) / (n - 1)); a level line where nothing is learned. Of more than five curves those that are 0 at most "
    "points are not drawn but told in words.",
    [argument("curves", metavar="LABEL=FILE.csv", nargs="+", type=source,
              help="a label, and a trials.csv or sweep.csv; the labels %s have the colours of the paper's curves"
              % "; ".join(method[0] for method in METHODS)),
     argument("--published", metavar="FILE.csv",
              help="also draw the paper's curves: results/published/success_rate.csv of ddm_launch"),
     argument("--wilson", action="store_true", help="draw Wilson's 95 %% intervals as bands instead of our standard errors, "
              "which are 0 where all seeds succeed")], draw)
