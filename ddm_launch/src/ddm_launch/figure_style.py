# Style of all figures in print: sizes, fonts, colours and file format.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import collections
import contextlib
import io

import matplotlib
matplotlib.use("Agg")  # draws without a display
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

from ddm_launch.command import Failure  # noqa: E402
from ddm_model.plain_file import write_file  # noqa: E402

# Widths for one column and for two columns [in]. Figures are printed at this size.
COLUMN_WIDTH, PAGE_WIDTH = 3.4, 7.0

# Colours of the Okabe-Ito set, which colour-blind readers can distinguish. Figures also vary markers and dashes.
ORANGE, SKY, GREEN, YELLOW = "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILLION, PURPLE, BLACK = "#0072B2", "#D55E00", "#CC79A7", "#000000"
GREY = "#666666"  # for references

# Colour and marker of each method in all figures.
METHOD_STYLES = {"DDM + MPC": (BLUE, "o"), "efficient": (BLACK, "X"), "oracle": (ORANGE, "P"), "PILCO, state": (VERMILLION, "s"),
                 "PILCO, features": (GREEN, "D"), "PILCO, PCA": (PURPLE, "^"), "MR.Q": (SKY, "v"), "DreamerV3": (PURPLE, "<"),
                 "DrQ-v2": (GREEN, ">"), "Dreamer v1": (GREY, "*")}

SETTINGS = {"font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8, "xtick.labelsize": 7, "ytick.labelsize": 7,
            "legend.fontsize": 7, "axes.linewidth": 0.6, "lines.linewidth": 1.2, "lines.markersize": 4,
            "figure.constrained_layout.w_pad": 0.03, "figure.constrained_layout.h_pad": 0.03,
            "figure.constrained_layout.wspace": 0.02, "figure.constrained_layout.hspace": 0.02,
            "grid.color": "#dddddd", "grid.linewidth": 0.5, "axes.axisbelow": True, "legend.framealpha": 0.9}
SCREEN = {"settings": {}, "dpi": 150}  # matplotlib's default style


# A kind of figure. about: description; --help lists its first sentence. arguments: results of argument().
# draw(options): writes the file options.out. suffix: suffix of this file.
Figure = collections.namedtuple("Figure", "about arguments draw suffix", defaults=(".png",))


def argument(*words, **settings):
    """Makes an argument of a figure's subcommand, from the arguments of argparse.add_argument()."""
    return words, settings


def labelled(text):
    """Parses LABEL=PATH. Returns (label, path)."""
    label, _, path = text.partition("=")
    if not (label and path):
        raise argparse.ArgumentTypeError("must be LABEL=PATH, got '%s'" % text)
    return label, path


@contextlib.contextmanager
def new_figure(width, height, settings=SETTINGS, dpi=200):
    """Context with a new figure of this size [in], which is closed at the end. `**SCREEN` makes a figure for screens."""
    with plt.rc_context(settings):
        figure = plt.figure(figsize=(width, height), dpi=dpi, constrained_layout=True)
        try:
            yield figure
        finally:
            plt.close(figure)


def save(figure, out):
    """Writes a PNG without time stamp and program name, so that equal figures give equal bytes.

    Raises Failure if the file name does not end in .png, OSError if the file cannot be written.
    """
    if not out.lower().endswith(".png"):
        raise Failure("the figure must be a .png, got '%s': give --out another name" % out)
    figure.canvas.draw()
    image = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    image = image.quantize(256)  # halves the file; the colours of smoothed edges change by an invisible amount
    save_image(image, out, "PNG", optimize=True, dpi=(figure.dpi, figure.dpi))


def panel_above_legend(figure):
    """Splits a figure. Returns (axes, place in a grid for add_legend() below them)."""
    grid = figure.add_gridspec(2, 1, height_ratios=[1.0, 0.001])
    return figure.add_subplot(grid[0]), grid[1]


def add_legend(figure, place, handles, labels, **options):
    axes = figure.add_subplot(place)
    axes.axis("off")
    axes.legend(handles, labels, loc="center", frameon=False, **options)


def show_image(axes, image, **options):
    axes.imshow(image, cmap="gray", vmin=0, vmax=255, **options)
    axes.set_xticks([])
    axes.set_yticks([])


def save_image(image, out, file_format, **options):
    """Writes a PIL image into a file. Raises OSError if the file cannot be written."""
    stream = io.BytesIO()
    image.save(stream, format=file_format, **options)
    write_file(out, stream.getvalue())
