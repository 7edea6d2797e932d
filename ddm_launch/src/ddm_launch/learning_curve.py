# Draws the learning curve of an experiment: the final error after each trial. The node publishes it as an image.
# SPDX-License-Identifier: BSD-3-Clause
import io
import os

import numpy as np
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import String
import yaml

from ddm_launch.command import Failure
from ddm_launch.figure_style import BLUE, GREY, ORANGE, SCREEN, VERMILLION, Figure, argument, new_figure, save
from ddm_launch.run_folder import LOADER, read_setting, read_trials


def draw_one(axes, trials, unit, tolerance):
    """Draws the final error of the evaluations over the number of frames learned from. Markers distinguish successes
    from failures. If no final error is known, as on a robot, draws successes at 1 and failures at 0.

    trials: table of read_trials(). unit, tolerance: of the final error. Raises Failure if neither final errors nor
    successes are known.
    """
    has_errors = trials.final_error.notna().any()
    trials = trials.assign(height=trials.final_error if has_errors else trials.success).dropna(subset=["height"])
    if trials.empty:
        raise Failure("trials.csv has neither final error nor success in any row: there is nothing to draw")
    axes.plot(trials.frames, trials.height, color=GREY, linewidth=1, zorder=1)
    for rows, marker, colour, label in ((trials.success > 0, "o", BLUE, "success"),
                                        (trials.success == 0, "X", VERMILLION, "no success"),
                                        (trials.success.isna(), "D", GREY, "success not known")):
        if rows.any():
            axes.scatter(trials.frames[rows], trials.height[rows], marker=marker, s=70, color=colour, edgecolors="white",
                         linewidths=0.8, zorder=2, label=label)
    if not has_errors:
        axes.set_ylim(-0.2, 1.2)
        axes.set_ylabel("success")
        return
    axes.axhline(tolerance, color=GREY, linewidth=1, linestyle="--", zorder=0)
    axes.set_ylim(bottom=0)
    if unit == "deg":
        axes.set_ylim(-6, 186)
        axes.set_yticks(sorted({0, tolerance, 45, 90, 135, 180}))
    axes.set_ylabel("distance from the goal at the end [%s]" % unit.replace("deg", "°"))


def draw(options):
    with new_figure(7.0, 4.2, **SCREEN) as figure:
        axes = figure.subplots()
        draw_one(axes, read_trials(os.path.join(options.folder, "trials.csv")), read_setting(options.folder, "goal/error_unit"),
                 float(read_setting(options.folder, "goal/tolerance")))
        axes.set_xlabel("frames learned from [image-torque pairs]")
        axes.set_xlim(left=0)
        axes.set_title("Greedy policy after each trial")
        axes.grid(True, color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.legend(loc="best")
        save(figure, options.out)


def image_of(text):
    """Draws the image for a message on the topic `trials`: 640 x 480 pixels, RGB. The curves start at the left edge and
    grow to the right."""
    news = yaml.load(text, Loader=LOADER)
    with new_figure(6.4, 4.8, dpi=100) as figure:
        above, below = figure.subplots(2, 1, sharex=True, gridspec_kw={"height_ratios": (3, 2)})
        if news["trials_csv"].count("\n") > 1:
            trials = read_trials(io.StringIO(news["trials_csv"]))
            for name, label, colour in (("v_r", "reconstruction V_R", GREY), ("v_p", "prediction V_P", ORANGE)):
                known = trials[trials[name] > 0.0]
                below.semilogy(known.frames, known[name] / known.frames, color=colour, marker=".", label=label)
            below.legend(loc="upper right")
            try:
                draw_one(above, trials, news["goal"]["error_unit"], news["goal"]["tolerance"])
            except Failure:
                above.set_title("success is not known: there is no ground truth")
        below.set_xlim(0, max(news["frames"], below.dataLim.x1))  # includes the frames of start/bags
        below.set_xlabel("frames learned from [image-torque pairs]")
        below.set_ylabel("errors per frame [grey²]")
        figure.canvas.draw()
        pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3]
    height, width = pixels.shape[:2]
    return Image(height=height, width=width, encoding="rgb8", step=3 * width, data=pixels.tobytes())


def main_of_node():
    rospy.init_node("learning_curve_node")
    publisher = rospy.Publisher("learning_curve_image", Image, queue_size=1, latch=True)
    rospy.Subscriber("trials", String, lambda trials: publisher.publish(image_of(trials.data)), queue_size=1)
    rospy.spin()
    return 0


FIGURE = Figure("The final error after each trial of a run. Where none is known, as on a robot, the successes.",
                [argument("folder", metavar="DIR", help="run folder (it holds trials.csv)")], draw)
