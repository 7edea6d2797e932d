# learning_curve_node: publishes the learning curve of the running experiment as an image after each trial.
# SPDX-License-Identifier: BSD-3-Clause
import os
import tempfile

import numpy as np
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import String
import yaml

from ddm_launch.command import Failure
from ddm_launch.figure_style import GREY, ORANGE, new_figure
from ddm_launch.learning_curve import draw_one
from ddm_launch.settings import LOADER
from ddm_launch.tables import read_table
from ddm_model.plain_file import write_file


def draw_model_errors(axes, path):
    """Draws V_R and V_P per frame, for models that have them."""
    table = read_table(path, "frames", "v_r", "v_p")
    for name, label, colour in (("v_r", "reconstruction V_R", GREY), ("v_p", "prediction V_P", ORANGE)):
        known = table[table[name] > 0.0]
        axes.semilogy(known.frames, known[name] / known.frames, color=colour, marker=".", label=label)
    axes.legend(loc="upper right")


def picture(text):
    """Draws the image for a message on the topic `trials`: 640 x 480 pixels, RGB. The curves start at the left edge and
    grow to the right."""
    trials = yaml.load(text, Loader=LOADER)
    with tempfile.TemporaryDirectory() as folder, new_figure(6.4, 4.8, dpi=100) as figure:
        table = os.path.join(folder, "trials.csv")
        write_file(os.path.join(folder, "config.yaml"), text)
        write_file(table, trials["trials_csv"])
        above, below = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (3, 2)})
        if trials["trials_csv"].count("\n") > 1:
            draw_model_errors(below, table)
            try:
                draw_one(above, folder)
            except Failure:
                above.set_title("success is not known: there is no ground truth")
        below.set_xlim(0, max(trials["frames"], below.dataLim.x1))  # includes the frames of start/bags
        below.set_xlabel("frames learned from [image-torque pairs]")
        below.set_ylabel("errors per frame [grey²]")
        figure.canvas.draw()
        pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3]
    height, width = pixels.shape[:2]
    return Image(height=height, width=width, encoding="rgb8", step=3 * width, data=pixels.tobytes())


def main():
    rospy.init_node("learning_curve_node")
    publisher = rospy.Publisher("learning_curve_image", Image, queue_size=1, latch=True)
    rospy.Subscriber("trials", String, lambda trials: publisher.publish(picture(trials.data)), queue_size=1)
    rospy.spin()
    return 0
