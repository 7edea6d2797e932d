# Draws a greedy evaluation of the pendulum as a film strip.
# SPDX-License-Identifier: BSD-3-Clause
import math

from ddm_launch.figure_style import BLUE, GREY, Figure, argument, new_screen_figure, save, show_image
from ddm_launch.images import Camera
from ddm_launch.run_folder import Evaluation, read_trials

NUM_IMAGES = 12


def swing_up_end(angles_rad, goal_rad, tolerance_rad):
    """The step to show the film up to: a little after the goal is reached for good, or the very last step."""
    away = [k for k, angle in enumerate(angles_rad) if abs(math.remainder(angle - goal_rad, 2.0 * math.pi)) >= tolerance_rad]
    arrival = away[-1] + 1 if away else 0
    last = len(angles_rad) - 1
    return min(last, arrival + max(5, arrival // 4))


def steps_to_show(end, num_steps):
    """Evenly spaced steps from 0 to `end` or a little beyond it: at most NUM_IMAGES, all below num_steps."""
    stride = max(1, math.ceil(end / (NUM_IMAGES - 1)))
    return list(range(0, num_steps, stride))[:NUM_IMAGES]


def default_trial(trials):
    """The last trial whose evaluation was a success, else the last one."""
    successes = [row.trial for row in trials if row.success]
    return successes[-1] if successes else trials[-1].trial


def draw_strip(evaluation, end, camera, out):
    """Images above, the torque over the same time below."""
    steps = steps_to_show(end, len(evaluation.time_s))
    last = steps[-1]
    period = evaluation.time_s[1] - evaluation.time_s[0]
    with new_screen_figure(len(steps) * 1.0 + 0.6, 3.0) as figure:
        grid = figure.add_gridspec(2, len(steps), height_ratios=[1.0, 1.1])
        for column, step in enumerate(steps):
            axes = figure.add_subplot(grid[0, column])
            show_image(axes, camera.shoot(evaluation.angle_rad[step], evaluation.rate_rad_per_s[step]))
            axes.set_title("%.1f s" % evaluation.time_s[step], fontsize=10)
        axes = figure.add_subplot(grid[1, :])
        edges = evaluation.time_s[:last + 1] + [evaluation.time_s[last] + period]
        torque = evaluation.torque_nm[:last + 1]
        axes.step(edges, torque + torque[-1:], where="post", color=BLUE)
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        for step in steps:
            axes.axvline(evaluation.time_s[step], color=GREY, linewidth=0.6, linestyle=":")
        axes.set_xlim(edges[0], edges[-1])
        axes.set_xlabel("time [s]")
        axes.set_ylabel("torque [N m]")
        save(figure, out)


def draw(options):
    trial = options.trial if options.trial is not None else default_trial(read_trials(options.folder))
    evaluation = Evaluation(options.folder, trial)
    camera = Camera(options.folder)
    end = swing_up_end(evaluation.angle_rad, camera.plant["goal"][0], math.radians(camera.plant["tolerance"]))
    draw_strip(evaluation, end, camera, options.out)
    print("evaluation after trial %d" % trial)


FIGURE = Figure("The greedy evaluation of a run folder. Images from the start until the rod is up, and the torque below.", [
    argument("folder", metavar="DIR", help="run folder (it holds trials.csv and evaluation_NNN)"),
    argument("--trial", type=int, metavar="N", help="default: the last that succeeded, else the last")], draw)
