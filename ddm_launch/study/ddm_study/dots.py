# Rows of dots with bars: what variants of a preset change, and success under each nuisance of the camera.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import textwrap

import numpy as np
from PIL import Image

from ddm_launch.figure_style import (COLUMN_WIDTH, GREY, SHADES, Figure, add_legend, argument, new_figure,
                                     panel_above_legend, save, show_image)
from ddm_study.results import differences, rates, read_table, variants

SPREAD = 0.3  # [rows] between the dots of one row
ROW_HEIGHT = 0.24  # [in]
# A dot and its bar from low to high in each row.
Series = collections.namedtuple("Series", "label colour marker values lows highs")

STYLES = ((SHADES[0], "s"), (SHADES[2], "o"))  # of the first frames, of the mean over the later ones
LABEL_LETTERS = 30  # in a line; longer labels would leave no room for the dots
LABELS = {"auto_encoder_widths": "the paper's auto-encoder", "blur": "no blur", "cost": "the paper's cost and horizon",
          "delay": "no choice of the delay", "epsilon": "the paper's share of random torques",
          "held_torques": "no held torques", "increments": "no increments", "offset": "no offset correction", "predictor_widths": "the paper's width of f",
          "residual": "no residual prediction", "selection": "starts chosen by what is minimised",
          "solver": "plain L-BFGS", "starts": "one start", "steps": "no multi-step loss", "warm_up": "no warm-up",
          "weight_decay": "no weight decay", "horizon": "plans of 8 steps", "iterations": "1000 iterations",
          "order": "order 3", "predictor_narrow": "a predictor half as wide"}
# The same names mean other values in the folder tried.
TRIED_LABELS = {"auto_encoder_widths": "a wider auto-encoder", "starts": "6 starts"}

IMAGE_HEIGHT, IMAGE_LEFT = 0.9, -0.2  # [rows], and left edge [success rate]
IMAGE_STYLES = {100: (SHADES[0], "s"), 200: (SHADES[1], "v"), 500: (SHADES[2], "o")}  # images learned from


def draw_dots(figure, names, series, num_columns):
    """Dots above a legend. names: of the rows, from top to bottom; the first series is on top in each row. Returns the
    axes."""
    axes, place = panel_above_legend(figure)
    for k, each in enumerate(series):
        shift = SPREAD * (k - 0.5 * (len(series) - 1))
        values = np.asarray(each.values)
        axes.errorbar(values, np.arange(len(names)) + shift, xerr=[values - each.lows, each.highs - values],
                      color=each.colour, marker=each.marker, linestyle="none", capsize=2, elinewidth=0.8, label=each.label)
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels(names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.grid(True, axis="x")
    add_legend(figure, place, *axes.get_legend_handles_labels(), ncol=num_columns, columnspacing=1.2, handletextpad=0.4)
    return axes


def drawn_frames(table):
    """The first number of frames, and the mean over all later ones."""
    frames = list(dict.fromkeys(table.frames))
    return frames[:1] + [text for text in frames[-1:] if text != frames[0]]


def ablation_order(table):
    """Names of the variants of a table of differences(), the most harmful first."""
    drawn = table[table.frames.isin(drawn_frames(table))]
    return list(drawn.groupby("variant").difference.sum().sort_values(kind="stable").index)


def ablation_series(table):
    """Series of a table of differences(), in the order of ablation_order(). Bars are two standard errors to each side."""
    series = []
    for (colour, marker), text in zip(STYLES, drawn_frames(table)):
        rows = table[table.frames == text].set_index("variant").loc[ablation_order(table)]
        label = "mean of %s frames" % text if " " in text else "%s frames" % text
        series.append(Series(label, colour, marker, rows.difference.values, (rows.difference - 2.0 * rows.se).values,
                             (rows.difference + 2.0 * rows.se).values))
    return series


def draw_ablation(options):
    table = differences(options.folder, options.reference)
    names = ablation_order(table)
    labels = dict(LABELS, **TRIED_LABELS) if os.path.basename(os.path.abspath(options.folder)) == "tried" else LABELS
    texts = [textwrap.fill(labels.get(name, name), LABEL_LETTERS, break_on_hyphens=False) for name in names]
    with new_figure(COLUMN_WIDTH, 0.95 + ROW_HEIGHT * len(names)) as figure:
        axes = draw_dots(figure, texts, ablation_series(table), 1)
        axes.axvline(0.0, color=GREY, linewidth=0.8, zorder=1)
        axes.set_xlabel("difference of success rates [-]")
        save(figure, options.out)


def nuisance_series(folder):
    """(names of the rows, Series) of FOLDER/nuisances/NAME/trials.csv. The first row has the same seeds without any."""
    paths = variants(os.path.join(folder, "nuisances"))
    seeds = {seed for path in paths.values() for seed in read_table(path).seed}
    tables = {"none": rates(os.path.join(folder, "trials.csv"), seeds)}
    tables.update((name, rates(path)) for name, path in paths.items())
    return list(tables), [
        Series("%d images" % frames, *style, *(np.array([table[column][frames] for table in tables.values()])
                                               for column in ("rate", "low", "high")))
        for frames, style in IMAGE_STYLES.items() if all(frames in table.index for table in tables.values())]


def draw_nuisances(options):
    names, series = nuisance_series(options.folder)
    with new_figure(COLUMN_WIDTH, 0.85 + 1.6 * ROW_HEIGHT * len(names)) as figure:
        axes = draw_dots(figure, [name.replace("_", " ") for name in names], series, len(series))
        axes.set_xlim(IMAGE_LEFT - 0.02, 1.02)
        axes.set_xticks(np.linspace(0.0, 1.0, 6))
        axes.set_xlabel("success rate [-]")
        for row, name in enumerate(names):
            place = axes.inset_axes([IMAGE_LEFT, row - 0.5 * IMAGE_HEIGHT, -IMAGE_LEFT - 0.03, IMAGE_HEIGHT],
                                    transform=axes.transData)
            with Image.open(os.path.join(options.folder, "nuisances", name, "image.png")) as image:
                show_image(place, np.asarray(image))
        save(figure, options.out)


ABLATION = Figure(
    "What each variant of a preset changes of the success rate. Means over paired seeds with bars of two standard errors to "
    "each side, at the first number of frames and over all later ones; the most harmful on top.",
    [argument("folder", metavar="DIR", help="folder with DIR/VARIANT/trials.csv"),
     argument("--reference", required=True, metavar="FILE.csv", help="trials.csv of the preset itself")], draw_ablation)
NUISANCES = Figure(
    "Success rate under each nuisance of the camera after few and after more images, with Wilson's 95 % intervals and an "
    "image of each.",
    [argument("folder", metavar="DIR", help="folder with trials.csv, and trials.csv and image.png of each nuisance in "
              "DIR/nuisances/NAME")], draw_nuisances)
