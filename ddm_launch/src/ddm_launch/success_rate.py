# Draws success rates over the number of frames learned from, together with the curves of the paper's Fig. 8.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import itertools
import math

from matplotlib.colors import to_rgb
from matplotlib.ticker import MaxNLocator
import pandas

from ddm_launch.averages import success_rates
from ddm_launch.command import Failure
from ddm_launch.figure_style import (BLACK, COLUMN_WIDTH, GREY, METHOD_STYLES, SKY, YELLOW, Figure, add_legend, argument,
                                     labelled, new_figure, panel_above_legend, save)
from ddm_launch.run_folder import read_table, read_trials

# The paper's methods: name, column of the published rate, column of its standard error (None: not published). Our curve
# of a method has the same colour as the published curve.
METHODS = (("DDM + MPC", "ddm_mpc", "ddm_mpc_se"),
           ("PILCO, state", "pilco_state", "pilco_state_se"),
           ("PILCO, features", "pilco_autoencoder_features", None),
           ("PILCO, PCA", "pilco_pca20_features", None))
# Colours and markers of our curves whose names are not in METHOD_STYLES, in order.
OTHERS = ((SKY, "h"), (YELLOW, "p"), (BLACK, "d"), (GREY, "x"))
LONGEST_PAIR = 54  # largest total length of two labels that fit side by side in a column [characters]

# Success rates of one method. rates: table with the index frames and the columns rate, low and high; low and high are
# the ends of the error bars or of the band, or NaN if unknown.
Curve = collections.namedtuple("Curve", "name label rates is_ours")


def read_curve(name, path, wilson=False):
    """Reads the curve of a trials.csv or sweep.csv; its label has the number of seeds. wilson: use 95 % intervals
    instead of standard errors. Raises Failure if the success of all trials is unknown."""
    trials = read_trials(path)
    rates = success_rates(trials)
    if rates.empty:
        raise Failure("%s: the success is not known in any row: there is nothing to draw" % path)
    if not wilson:
        rates = rates.assign(low=rates.rate - rates.se, high=rates.rate + rates.se)
    count = trials.seed.nunique()
    return Curve(name, "%s (%d seed%s)" % (name, count, "" if count == 1 else "s"), rates, True)


def read_published(path):
    table = read_table(path, "frames", *(name for method in METHODS for name in method[1:] if name),
                       remedy="it is results/published/success_rate.csv of ddm_launch").set_index("frames")
    curves = []
    for name, rate, error in METHODS:
        error = table[error] if error else math.nan
        rates = pandas.DataFrame({"rate": table[rate], "low": table[rate] - error, "high": table[rate] + error})
        curves.append(Curve(name, name + " (paper)", rates, False))
    return curves


def draw_curves(axes, curves, wilson):
    """Draws our curves with full lines and markers, above the paper's curves, which are dashed, open and lighter.
    wilson: draws intervals of our curves as bands."""
    last_frames = max(100, *(curve.rates.index[-1] for curve in curves))
    others = itertools.cycle(OTHERS)
    for curve in curves:
        colour, marker = METHOD_STYLES.get(curve.name) or next(others)
        rates, look = curve.rates, dict(color=colour, linestyle="-", elinewidth=0.8, zorder=3)
        if list(rates.index) == [0]:  # a level line for a method that learns from no images, such as the oracle
            rates, look["zorder"] = pandas.concat([rates, rates.set_axis([last_frames])]), 1
        if not curve.is_ours:
            look = dict(color=tuple(0.5 + 0.5 * part for part in to_rgb(colour)), linestyle="--", elinewidth=0.7,
                        markerfacecolor="white", linewidth=0.9, zorder=2)
        errors = (rates.high - rates.rate) if rates.high.notna().all() else None
        if curve.is_ours and wilson:
            axes.fill_between(rates.index, rates.low, rates.high, color=colour, alpha=0.2, linewidth=0.0, zorder=1)
            errors = None
        axes.errorbar(rates.index, rates.rate, yerr=errors, marker=marker, capsize=2, label=curve.label, **look)
    axes.set_xlim(left=-40)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
    axes.set_ylim(-0.04, 1.04)
    axes.set_xlabel("frames learned from [image-torque pairs]")
    axes.set_ylabel("success rate")
    axes.grid(True)


def draw(options):
    curves = [read_curve(label, path, options.wilson) for label, path in options.curves]
    curves += read_published(options.published) if options.published else []
    with new_figure(COLUMN_WIDTH, 2.45) as figure:
        axes, place = panel_above_legend(figure)
        draw_curves(axes, curves, options.wilson)
        handles, labels = axes.get_legend_handles_labels()
        num_columns = 2 if sum(sorted(map(len, labels))[-2:]) <= LONGEST_PAIR else 1
        figure.set_size_inches(COLUMN_WIDTH, 2.45 + 0.15 * math.ceil(len(labels) / num_columns))
        add_legend(figure, place, handles, labels, ncol=num_columns, columnspacing=0.8, handlelength=2.2,
                   handletextpad=0.5)
        save(figure, options.out)


FIGURE = Figure(
    "Success rate over the frames learned from. One curve per file of many seeds, with the standard error "
    "sqrt(p (1 - p) / (n - 1)); a level line where nothing is learned.",
    [argument("curves", metavar="LABEL=FILE.csv", nargs="+", type=labelled,
              help="a label, and a trials.csv or sweep.csv; the labels %s have the colours of the paper's curves"
              % "; ".join(method[0] for method in METHODS)),
     argument("--published", metavar="FILE.csv",
              help="also draw the paper's curves: results/published/success_rate.csv of ddm_launch"),
     argument("--wilson", action="store_true", help="draw Wilson's 95 %% intervals as bands instead of our standard errors, "
              "which are 0 where all seeds succeed")], draw)
