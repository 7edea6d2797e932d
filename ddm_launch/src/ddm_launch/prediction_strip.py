# Draws what a model predicts 1, 2, ... steps ahead below what really happened.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os

from ddm_launch.figure_style import PAGE_WIDTH, new_figure, save, write
from ddm_launch.images import Camera, Decoder
from ddm_launch.run_folder import RunFolderError, number, read_csv

REMEDY = "is its folder one that prediction_experiment has written?"


class Strip:
    """strip.csv: a prediction from step 0 on. Lists of one entry per column of the figure."""

    def __init__(self, folder):
        path = os.path.join(folder, "strip.csv")
        rows = read_csv(path, ["steps", "z_1"], REMEDY)
        features = [name for name in rows[0] if name.startswith("z_")]
        state = [name for name in rows[0] if name != "steps" and name not in features]
        if not state:
            raise RunFolderError("%s has no column of the true state, only: %s" % (path, ", ".join(rows[0])))
        self.steps = [int(number(row, "steps", path)) for row in rows]
        self.states = [[number(row, name, path) for name in state] for row in rows]
        self.features = [[number(row, name, path) for name in features] for row in rows]


def column_label(steps):
    return "now" if steps == 0 else "+%d" % steps


def draw_strip(figure, strip, camera, decoder):
    """True images above, those of the model below; the first column is the frame from which it predicts."""
    true = [camera.shoot(*state) for state in strip.states]
    predicted = decoder.decode(strip.features)
    grid = figure.add_gridspec(2, len(strip.steps))
    for row, (label, images) in enumerate((("true", true), ("predicted", predicted))):
        for column, image in enumerate(images):
            axes = figure.add_subplot(grid[row, column])
            axes.imshow(image, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
            axes.set_xticks([])
            axes.set_yticks([])
            if row == 0:
                axes.set_title(column_label(strip.steps[column]), pad=3)
            if column == 0:
                axes.set_ylabel(label, labelpad=3)
    figure.axes[len(strip.steps) + len(strip.steps) // 2].set_xlabel("steps ahead [-]")


def draw(folder, out, make_camera=Camera, make_decoder=Decoder):
    """Draws the strip of a folder of prediction_experiment into a picture file."""
    strip = Strip(folder)
    camera, decoder = make_camera(folder), make_decoder(os.path.join(folder, "model.ddm"))
    with new_figure(PAGE_WIDTH, 1.85) as figure:
        draw_strip(figure, strip, camera, decoder)
        save(figure, out)


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="prediction_strip",
        description="Draws true images (above) and long-term predictions of the same frames (below), from the "
        "strip.csv, model.ddm and config.yaml of a folder of prediction_experiment. The column 'now' is the frame "
        "from which the model predicts: below it stands its reconstruction.")
    parser.add_argument("folder", metavar="DIR", help="folder of prediction_experiment")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("prediction_strip", options.out, lambda out: draw(options.folder, out))
