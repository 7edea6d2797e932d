# Draws a greedy evaluation as a film strip (PNG) and as an animation (GIF).
# SPDX-License-Identifier: BSD-3-Clause
import math

from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont

from ddm_launch.figure_style import BLUE, GREY, new_screen_figure, save, save_picture, show_image
from ddm_launch.images import Camera
from ddm_launch.run_folder import Evaluation, read_trials

ABOUT = ("The greedy evaluation of a run folder. Images from the start until the rod is up, and the torque below; "
         "--gif writes an animation of it.")
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


def shoot(camera, evaluation, step):
    return camera.shoot(evaluation.angle_rad[step], evaluation.rate_rad_per_s[step])


def draw_strip(evaluation, end, camera, out):
    """Images above, the torque over the same time below."""
    steps = steps_to_show(end, len(evaluation.time_s))
    last = steps[-1]
    period = evaluation.time_s[1] - evaluation.time_s[0]
    with new_screen_figure(len(steps) * 1.0 + 0.6, 3.0) as figure:
        grid = figure.add_gridspec(2, len(steps), height_ratios=[1.0, 1.1])
        for column, step in enumerate(steps):
            axes = figure.add_subplot(grid[0, column])
            show_image(axes, shoot(camera, evaluation, step))
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


def draw_animation(evaluation, end, camera, out):
    """All images up to step `end` in real time, the time and the torque written and drawn below each."""
    size, footer = 256, 44
    largest = max(1e-9, max(abs(torque) for torque in evaluation.torque_nm))
    font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 15)
    pictures = []
    for step in range(end + 1):
        torque = evaluation.torque_nm[step]
        image = shoot(camera, evaluation, step)
        picture = Image.new("RGB", (size, size + footer), "white")
        picture.paste(image.resize((size, size), Image.NEAREST), (0, 0))
        pen = ImageDraw.Draw(picture)
        pen.text((8, size + 4), "%4.1f s" % evaluation.time_s[step], fill="black", font=font)
        pen.text((130, size + 4), "%+5.1f N m" % torque, fill="black", font=font)
        middle, tip = size // 2, size // 2 + round(torque / largest * (size // 2 - 8))
        pen.rectangle([min(middle, tip), size + 28, max(middle, tip), size + 38], fill=BLUE)
        pen.line([middle, size + 25, middle, size + 41], fill=GREY)
        pictures.append(picture)
    period = round(1000 * (evaluation.time_s[1] - evaluation.time_s[0]))  # [ms]
    durations = [period] * end + [1500]  # the last image stays, then it starts over
    save_picture(pictures[0], out, "GIF", save_all=True, append_images=pictures[1:], duration=durations, loop=0)


def add_arguments(parser):
    parser.add_argument("folder", metavar="DIR", help="run folder (it holds trials.csv and evaluation_NNN)")
    parser.add_argument("--trial", type=int, metavar="N", help="default: the last that succeeded, else the last")
    parser.add_argument("--gif", metavar="FILE.gif", help="also write an animation in real time")


def draw(options):
    trial = options.trial if options.trial is not None else default_trial(read_trials(options.folder))
    evaluation = Evaluation(options.folder, trial)
    camera = Camera(options.folder)
    end = swing_up_end(evaluation.angle_rad, camera.plant["goal"][0], math.radians(camera.plant["tolerance"]))
    draw_strip(evaluation, end, camera, options.out)
    print("evaluation after trial %d" % trial)
    if options.gif:
        draw_animation(evaluation, end, camera, options.gif)
        print("wrote %s" % options.gif)
