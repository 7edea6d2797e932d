# Rows of dots with horizontal bars: what a figure draws that compares variants by one number each.
# SPDX-License-Identifier: BSD-3-Clause
import collections

from ddm_launch.figure_style import add_legend, panel_above_legend

SPREAD = 0.3  # [rows] between the dots of one row
ROW_HEIGHT = 0.24  # [in]

# A dot and its bar from low to high in each row.
Series = collections.namedtuple("Series", "label colour marker values lows highs")


def draw_figure_of_dots(figure, names, series, num_columns):
    """The dots above a legend. names: of the rows, from top to bottom; the dots of a row are below each other, the first
    series on top. Returns the axes."""
    axes, place = panel_above_legend(figure)
    for k, each in enumerate(series):
        shift = SPREAD * (k - 0.5 * (len(series) - 1))
        errors = [[value - low for value, low in zip(each.values, each.lows)],
                  [high - value for value, high in zip(each.values, each.highs)]]
        axes.errorbar(each.values, [row + shift for row in range(len(names))], xerr=errors, color=each.colour,
                      marker=each.marker, linestyle="none", capsize=2, elinewidth=0.8, label=each.label)
    axes.set_yticks(range(len(names)))
    axes.set_yticklabels(names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.grid(True, axis="x")
    add_legend(figure, place, *axes.get_legend_handles_labels(), ncol=num_columns, columnspacing=1.2, handletextpad=0.4)
    return axes
