# Draws what a model predicts 1, 2, ... steps ahead below what really happened.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.command import Failure
from ddm_launch.figure_style import PAGE_WIDTH, new_figure, save, show_image
from ddm_launch.images import Camera, Decoder
from ddm_launch.tables import read_csv

ABOUT = ("True images, and the model's long-term predictions of the same frames below. From a folder of "
         "prediction_experiment. The column 'now' is the frame from which the model predicts; below it is its "
         "reconstruction.")
REMEDY = "is its folder one that prediction_experiment has written?"


class Strip:
    """strip.csv: a prediction from step 0 on. Lists of one entry per column of the figure."""

    def __init__(self, folder):
        path = os.path.join(folder, "strip.csv")
        names = list(read_csv(path, ["steps", "z_1"], REMEDY)[0])
        rows = read_csv(path, dict.fromkeys(names, float), REMEDY)
        features = [name for name in names if name.startswith("z_")]
        state = [name for name in names if name != "steps" and name not in features]
        if not state:
            raise Failure("%s has no column of the true state, only: %s" % (path, ", ".join(names)))
        self.steps = [int(row["steps"]) for row in rows]
        self.states, self.features = ([[row[name] for name in some] for row in rows] for some in (state, features))


def draw_strip(figure, strip, camera, decoder):
    """True images above, those of the model below; the first column is the frame from which it predicts."""
    images = [("true", [camera.shoot(*state) for state in strip.states]), ("predicted", decoder.decode(strip.features))]
    axes = figure.subplots(2, len(strip.steps))
    for of_row, (label, of_label) in zip(axes, images):
        of_row[0].set_ylabel(label, labelpad=3)
        for one, image in zip(of_row, of_label):
            show_image(one, image, interpolation="nearest")
    for one, steps in zip(axes[0], strip.steps):
        one.set_title("+%d" % steps if steps else "now", pad=3)
    axes[1][len(strip.steps) // 2].set_xlabel("steps ahead [-]")


def add_arguments(parser):
    parser.add_argument("folder", metavar="DIR", help="folder of prediction_experiment")


def draw(options):
    strip = Strip(options.folder)
    with new_figure(PAGE_WIDTH, 1.85) as figure:
        draw_strip(figure, strip, Camera(options.folder), Decoder(os.path.join(options.folder, "model.ddm")))
        save(figure, options.out)
