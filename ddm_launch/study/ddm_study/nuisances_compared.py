# Draws the success rate under each nuisance of the camera, with 95 % intervals.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.figure_style import BLUE, COLUMN_WIDTH, PURPLE, SKY, new_figure, save
from ddm_launch.tables import read_csv
from ddm_study.dot_plot import ROW_HEIGHT, Series, draw_figure_of_dots
from ddm_study.efficient_tables import INTERVALS, REMEDY

ABOUT = "Success rate under each nuisance of the camera after few and after more images, with Wilson's 95 % intervals."
STYLES = {100: (PURPLE, "s"), 200: (SKY, "v"), 500: (BLUE, "o")}  # images learned from: colour, marker


def read_series(path):
    """(names of the rows, Series of each number of images in STYLES that the table has) of a nuisances.csv."""
    rows = read_csv(path, dict(dict.fromkeys(INTERVALS, float), nuisance=str, frames=int), REMEDY, ("nuisance", "frames"))
    names = list(dict.fromkeys(row["nuisance"] for row in rows))
    series = []
    for frames, style in STYLES.items():
        found = {row["nuisance"]: row for row in rows if row["frames"] == frames}
        if len(found) == len(names):
            series.append(Series("%d images" % frames, *style,
                                 *([found[name][column] for name in names] for column in INTERVALS[:3])))
    return [name.replace("_", " ") for name in names], series


def add_arguments(parser):
    parser.add_argument("table", metavar="FILE.csv", help="nuisances.csv of reproduce_efficient")


def draw(options):
    names, series = read_series(options.table)
    with new_figure(COLUMN_WIDTH, 0.85 + 1.4 * ROW_HEIGHT * len(names)) as figure:
        axes = draw_figure_of_dots(figure, names, series, max(1, len(series)))
        axes.set_xlim(-0.02, 1.02)
        axes.set_xlabel("success rate [-]")
        save(figure, options.out)
