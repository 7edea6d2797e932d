# How the figures of the paper's experiments look in print: sizes, letters, colours, and how they are saved.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import contextlib
import io

import matplotlib
matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

from ddm_launch.command import Failure  # noqa: E402
from ddm_model.plain_file import write_file  # noqa: E402

COLUMN_WIDTH, PAGE_WIDTH = 3.4, 7.0  # [in], to be printed at this size, in one column or across two
DPI = 200

# The Okabe-Ito set: colour-blind readers can distinguish them. Figures vary shapes and dashes along with them.
ORANGE, SKY, GREEN, YELLOW = "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILLION, PURPLE, BLACK = "#0072B2", "#D55E00", "#CC79A7", "#000000"
GREY = "#666666"  # for references
SHADES = ("#b0b0b0", GREY, BLACK)  # of one method, in figures that compare its settings

# Colour and marker of each method, in every figure.
METHOD_STYLES = {"DDM + MPC": (BLUE, "o"), "efficient": (BLACK, "X"), "oracle": (ORANGE, "P"), "PILCO, state": (VERMILLION, "s"),
                 "PILCO, features": (GREEN, "D"), "PILCO, PCA": (PURPLE, "^"), "MR.Q": (SKY, "v"), "DreamerV3": (PURPLE, "<"),
                 "DrQ-v2": (GREEN, ">"), "Dreamer v1": (GREY, "*")}

SETTINGS = {"font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8, "xtick.labelsize": 7, "ytick.labelsize": 7,
            "legend.fontsize": 7, "axes.linewidth": 0.6, "lines.linewidth": 1.2, "lines.markersize": 4,
            "figure.constrained_layout.w_pad": 0.03, "figure.constrained_layout.h_pad": 0.03,
            "figure.constrained_layout.wspace": 0.02, "figure.constrained_layout.hspace": 0.02,
            "grid.color": "#dddddd", "grid.linewidth": 0.5, "axes.axisbelow": True, "legend.framealpha": 0.9}


# A kind of figure. about: what it draws; --help lists its first sentence. arguments: of argument(). draw(options): writes
# options.out, a file with this suffix.
Figure = collections.namedtuple("Figure", "about arguments draw suffix", defaults=(".png",))


def argument(*words, **settings):
    """An argument of a figure's program, as argparse.add_argument() takes it."""
    return words, settings


@contextlib.contextmanager
def new_figure(width, height, settings=SETTINGS, dpi=DPI):
    """A figure of this size [in], closed at the end of the `with`."""
    with plt.rc_context(settings):
        figure = plt.figure(figsize=(width, height), dpi=dpi, constrained_layout=True)
        try:
            yield figure
        finally:
            plt.close(figure)


def new_screen_figure(width, height):
    """A figure in matplotlib's own style."""
    return new_figure(width, height, settings={}, dpi=150)


def require_png(out):
    """Raises Failure if the name has another suffix."""
    if not out.lower().endswith(".png"):
        raise Failure("the picture must be a .png, got '%s': give --out another name" % out)


def save(figure, out):
    """Writes a PNG without time or program in it: the same figure gives the same bytes.

    Raises Failure if the name has another suffix, OSError if it cannot be written.
    """
    require_png(out)
    figure.canvas.draw()
    picture = Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB")
    picture = picture.quantize(256)  # about half as large; only the colours of smoothed edges move, and not visibly
    save_picture(picture, out, "PNG", optimize=True, dpi=(figure.dpi, figure.dpi))


def panel_above_legend(figure):
    """(axes, place for add_legend() below them)"""
    grid = figure.add_gridspec(2, 1, height_ratios=[1.0, 0.001])
    return figure.add_subplot(grid[0]), grid[1]


def add_legend(figure, place, handles, labels, **options):
    """A legend alone in a place of a grid."""
    axes = figure.add_subplot(place)
    axes.axis("off")
    axes.legend(handles, labels, loc="center", frameon=False, **options)


def show_image(axes, image, **options):
    """A grey image without ticks."""
    axes.imshow(image, cmap="gray", vmin=0, vmax=255, **options)
    axes.set_xticks([])
    axes.set_yticks([])


def save_picture(picture, out, file_format, **options):
    """Writes a PIL image. Raises OSError if the file cannot be written."""
    stream = io.BytesIO()
    picture.save(stream, format=file_format, **options)
    write_file(out, stream.getvalue())
