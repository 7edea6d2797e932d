# Rows of dots with horizontal bars: what a figure draws that compares variants by one number each.
# SPDX-License-Identifier: BSD-3-Clause
SPREAD = 0.3  # [rows] between the dots of one row


class Series:
    """A dot and its bar from low to high in each row."""

    def __init__(self, label, colour, marker, values, lows, highs):
        self.label, self.colour, self.marker = label, colour, marker
        self.values, self.lows, self.highs = values, lows, highs


def draw_dots(axes, names, series):
    """names: of the rows, from top to bottom. The dots of a row stand below each other, the first series on top."""
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


def draw_legend_below(figure, grid, axes, num_columns):
    legend = figure.add_subplot(grid)
    legend.axis("off")
    legend.legend(*axes.get_legend_handles_labels(), loc="center", ncol=num_columns, columnspacing=1.2,
                  frameon=False, handletextpad=0.4)
