# Draws what each ingredient of a preset is worth: paired differences of the success rate without it.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import textwrap

from ddm_launch.dot_plot import Series, draw_dots, draw_legend_below
from ddm_launch.efficient_tables import PRESET, REMEDY
from ddm_launch.figure_style import BLUE, COLUMN_WIDTH, GREY, VERMILLION, new_figure, save, write
from ddm_launch.run_folder import RunFolderError, number, read_csv

NUM_ERRORS = 2.0  # half a bar [standard errors]
STYLES = ((VERMILLION, "s"), (BLUE, "o"))  # of the first frames, of the mean over the later ones
ROW_HEIGHT, REST_HEIGHT = 0.24, 0.95  # [in]
LABEL_LETTERS = 30  # in a line; longer labels would leave no room for what they name


class Difference:
    """A row of ablation.csv."""

    def __init__(self, row, path):
        self.variant, self.label, self.frames = row["variant"], row["label"], row["frames"]
        self.seeds = int(number(row, "seeds", path))
        self.mean, self.error = number(row, "difference", path), number(row, "difference_se", path)


def read_differences(path):
    """({variant: {frames: Difference}}, frames to draw): the worst variant comes first, the preset itself is left out.

    To be drawn are the first number of frames and, where there are more, the mean over the later ones.
    """
    variants, frames = {}, []
    for row in read_csv(path, ["variant", "label", "frames", "seeds", "difference", "difference_se"], REMEDY):
        difference = Difference(row, path)
        if difference.frames not in frames:
            frames.append(difference.frames)
        if difference.variant != PRESET:
            variants.setdefault(difference.variant, {})[difference.frames] = difference
    if not variants:
        raise RunFolderError("%s has no row of any variant but %s: there is nothing to draw" % (path, PRESET))
    drawn = frames[:1] + [text for text in frames[-1:] if text != frames[0]]
    for variant, by_frames in variants.items():
        if any(text not in by_frames for text in drawn):
            raise RunFolderError("%s has no row of %s at %s frames: %s" % (path, variant, " or ".join(drawn), REMEDY))
    worst_first = sorted(variants, key=lambda variant: sum(variants[variant][text].mean for text in drawn))
    return {variant: variants[variant] for variant in worst_first}, drawn


def draw_differences(axes, variants, frames):
    series = []
    for (colour, marker), text in zip(STYLES, frames):
        rows = [by_frames[text] for by_frames in variants.values()]
        label = "mean of %s frames" % text if " " in text else "%s frames" % text
        series.append(Series(label, colour, marker, [row.mean for row in rows],
                             [row.mean - NUM_ERRORS * row.error for row in rows],
                             [row.mean + NUM_ERRORS * row.error for row in rows]))
    axes.axvline(0.0, color=GREY, linewidth=0.8, zorder=1)
    labels = [textwrap.fill(by_frames[frames[0]].label, LABEL_LETTERS, break_on_hyphens=False)
              for by_frames in variants.values()]
    draw_dots(axes, labels, series)
    axes.set_xlabel("difference of success rates [-]")


def draw_figure(figure, variants, frames):
    grid = figure.add_gridspec(2, 1, height_ratios=[1.0, 0.001])
    axes = figure.add_subplot(grid[0])
    draw_differences(axes, variants, frames)
    draw_legend_below(figure, grid[1], axes, 1)


def draw(path, out):
    variants, frames = read_differences(path)
    with new_figure(COLUMN_WIDTH, REST_HEIGHT + ROW_HEIGHT * len(variants)) as figure:
        draw_figure(figure, variants, frames)
        save(figure, out)


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="ablation_compared",
        description="Draws by how much the success rate differs from that of the full preset when one ingredient is "
        "taken away: means over paired seeds with bars of %g standard errors to each side, at the first number of "
        "frames and over all later ones; the most harmful on top." % NUM_ERRORS)
    parser.add_argument("table", metavar="FILE.csv", help="ablation.csv of reproduce_efficient")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("ablation_compared", options.out, lambda out: draw(options.table, out))
