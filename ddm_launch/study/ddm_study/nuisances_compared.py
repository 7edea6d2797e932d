# Draws the success rate under each nuisance of the camera, with 95 % intervals.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.figure_style import BLUE, COLUMN_WIDTH, SKY, new_figure, save
from ddm_launch.tables import read_csv
from ddm_study.dot_plot import ROW_HEIGHT, Series, draw_figure_of_dots
from ddm_study.efficient_tables import INTERVALS, REMEDY

ABOUT = "Success rate under each nuisance of the camera, strict and not, with Wilson's 95 % intervals."
STYLES = (("success", BLUE, "o"), ("success_strict", SKY, "v"))


def read_series(path):
    """(names of the rows, Series of both measures, frames) of a nuisances.csv."""
    rows = read_csv(path, dict(dict.fromkeys(INTERVALS, float), nuisance=str, frames=int), REMEDY)
    series = [Series(*style, *([row[column] for row in rows] for column in columns))
              for style, columns in zip(STYLES, (INTERVALS[:3], INTERVALS[3:]))]
    return [row["nuisance"].replace("_", " ") for row in rows], series, sorted({row["frames"] for row in rows})


def add_arguments(parser):
    parser.add_argument("table", metavar="FILE.csv", help="nuisances.csv of reproduce_efficient")


def draw(options):
    names, series, frames = read_series(options.table)
    with new_figure(COLUMN_WIDTH, 0.85 + ROW_HEIGHT * len(names)) as figure:
        axes = draw_figure_of_dots(figure, names, series, 2)
        axes.set_xlim(-0.02, 1.02)
        axes.set_xlabel("success rate after %s frames [-]" % " or ".join(map(str, frames)))
        save(figure, options.out)
