# Draws the success rate under each nuisance of the camera, with 95 % intervals.
# SPDX-License-Identifier: BSD-3-Clause
import argparse

from ddm_launch.dot_plot import Series, draw_dots, draw_legend_below
from ddm_launch.efficient_tables import INTERVALS, REMEDY
from ddm_launch.figure_style import BLUE, COLUMN_WIDTH, SKY, new_figure, save, write
from ddm_launch.run_folder import number, read_csv

STYLES = (("success", BLUE, "o"), ("success_strict", SKY, "v"))
ROW_HEIGHT, REST_HEIGHT = 0.24, 0.85  # [in]


def read_series(path):
    """(names of the rows, Series of both measures, frames) of a nuisances.csv."""
    rows = read_csv(path, ["nuisance", "frames"] + INTERVALS, REMEDY)
    series = [Series(label, colour, marker, *([number(row, column, path) for row in rows] for column in columns))
              for (label, colour, marker), columns in zip(STYLES, (INTERVALS[:3], INTERVALS[3:]))]
    frames = sorted({int(number(row, "frames", path)) for row in rows})
    return [row["nuisance"].replace("_", " ") for row in rows], series, frames


def draw(path, out):
    names, series, frames = read_series(path)
    with new_figure(COLUMN_WIDTH, REST_HEIGHT + ROW_HEIGHT * len(names)) as figure:
        grid = figure.add_gridspec(2, 1, height_ratios=[1.0, 0.001])
        axes = figure.add_subplot(grid[0])
        draw_dots(axes, names, series)
        axes.set_xlim(-0.02, 1.02)
        axes.set_xlabel("success rate after %s frames [-]" % " or ".join(map(str, frames)))
        draw_legend_below(figure, grid[1], axes, 2)
        save(figure, out)


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="nuisances_compared",
        description="Draws the success rate under each nuisance, strict and not, with Wilson's 95 % intervals.")
    parser.add_argument("table", metavar="FILE.csv", help="nuisances.csv of reproduce_efficient")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("nuisances_compared", options.out, lambda out: draw(options.table, out))
