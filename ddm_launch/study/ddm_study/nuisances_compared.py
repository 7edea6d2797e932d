# Draws the success rate under each nuisance of the camera, with 95 % intervals.
# SPDX-License-Identifier: BSD-3-Clause
import os

import numpy as np
from PIL import Image

from ddm_launch.figure_style import COLUMN_WIDTH, SHADES, new_figure, save, show_image
from ddm_launch.tables import read_csv
from ddm_study.dot_plot import ROW_HEIGHT, Series, draw_figure_of_dots
from ddm_study.efficient_tables import INTERVALS, REMEDY

ABOUT = ("Success rate under each nuisance of the camera after few and after more images, with Wilson's 95 % intervals, and "
         "an image with each, where nuisances/NAME/image.png is next to the table.")
HEIGHT, LEFT = 0.9, -0.2  # of an image [rows], and its left edge [success rate]
STYLES = {100: (SHADES[0], "s"), 200: (SHADES[1], "v"), 500: (SHADES[2], "o")}  # images learned from: colour, marker


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


def add_images(axes, folder, names):
    """The image of each row, left of the dots. Returns whether there are any."""
    paths = [os.path.join(folder, "nuisances", name.replace(" ", "_"), "image.png") for name in names]
    for row, path in enumerate(paths):
        if os.path.exists(path):
            place = axes.inset_axes([LEFT, row - 0.5 * HEIGHT, -LEFT - 0.03, HEIGHT], transform=axes.transData)
            with Image.open(path) as image:
                show_image(place, np.asarray(image))
    return any(map(os.path.exists, paths))


def add_arguments(parser):
    parser.add_argument("table", metavar="FILE.csv", help="nuisances.csv of reproduce_efficient")


def draw(options):
    names, series = read_series(options.table)
    with new_figure(COLUMN_WIDTH, 0.85 + 1.6 * ROW_HEIGHT * len(names)) as figure:
        axes = draw_figure_of_dots(figure, names, series, max(1, len(series)))
        has_images = add_images(axes, os.path.dirname(options.table), names)
        axes.set_xlim(LEFT - 0.02 if has_images else -0.02, 1.02)
        axes.set_xticks(np.linspace(0.0, 1.0, 6))
        axes.set_xlabel("success rate [-]")
        save(figure, options.out)
