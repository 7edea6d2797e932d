# Draws what each ingredient of a preset is worth: paired differences of the success rate without it.
# SPDX-License-Identifier: BSD-3-Clause
import textwrap

from ddm_launch.command import Failure
from ddm_launch.figure_style import COLUMN_WIDTH, GREY, SHADES, new_figure, save
from ddm_launch.tables import read_csv
from ddm_study.dot_plot import ROW_HEIGHT, Series, draw_figure_of_dots
from ddm_study.efficient_tables import PRESET, REMEDY

ABOUT = ("Difference of the success rate without each ingredient of the preset. Means over paired seeds with bars of two "
         "standard errors to each side, at the first number of frames and over all later ones; the most harmful on top.")
NUM_ERRORS = 2.0  # half a bar [standard errors]
STYLES = ((SHADES[0], "s"), (SHADES[2], "o"))  # of the first frames, of the mean over the later ones
LABEL_LETTERS = 30  # in a line; longer labels would leave no room for what they name


def read_differences(path):
    """({variant: {frames: row}}, frames to draw): the worst variant comes first, the preset itself is left out.

    To be drawn are the first number of frames and, where there are more, the mean over the later ones.
    """
    variants, frames = {}, []
    columns = {"variant": str, "label": str, "frames": str, "seeds": int, "difference": float, "difference_se": float}
    for row in read_csv(path, columns, REMEDY):
        if row["frames"] not in frames:
            frames.append(row["frames"])
        if row["variant"] != PRESET:
            variants.setdefault(row["variant"], {})[row["frames"]] = row
    if not variants:
        raise Failure("%s has no row of any variant but %s: there is nothing to draw" % (path, PRESET))
    drawn = frames[:1] + [text for text in frames[-1:] if text != frames[0]]
    for variant, by_frames in variants.items():
        if any(text not in by_frames for text in drawn):
            raise Failure("%s has no row of %s at %s frames: %s" % (path, variant, " or ".join(drawn), REMEDY))
    worst_first = sorted(variants, key=lambda variant: sum(variants[variant][text]["difference"] for text in drawn))
    return {variant: variants[variant] for variant in worst_first}, drawn


def draw_figure(figure, variants, frames):
    series = []
    for (colour, marker), text in zip(STYLES, frames):
        rows = [by_frames[text] for by_frames in variants.values()]
        label = "mean of %s frames" % text if " " in text else "%s frames" % text
        series.append(Series(label, colour, marker, *(
            [row["difference"] + sign * NUM_ERRORS * row["difference_se"] for row in rows] for sign in (0.0, -1.0, 1.0))))
    labels = [textwrap.fill(by_frames[frames[0]]["label"], LABEL_LETTERS, break_on_hyphens=False)
              for by_frames in variants.values()]
    axes = draw_figure_of_dots(figure, labels, series, 1)
    axes.axvline(0.0, color=GREY, linewidth=0.8, zorder=1)
    axes.set_xlabel("difference of success rates [-]")


def add_arguments(parser):
    parser.add_argument("table", metavar="FILE.csv", help="ablation.csv or tried.csv of reproduce_efficient")


def draw(options):
    variants, frames = read_differences(options.table)
    with new_figure(COLUMN_WIDTH, 0.95 + ROW_HEIGHT * len(variants)) as figure:
        draw_figure(figure, variants, frames)
        save(figure, options.out)
