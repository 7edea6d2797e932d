# Draws the learning curve of a run: the final error after each trial.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.command import Failure
from ddm_launch.figure_style import BLUE, GREY, VERMILLION, Figure, argument, new_screen_figure, save
from ddm_launch.run_folder import read_goal, read_trials


def draw_one(axes, trials, goal):
    """Final error of the greedy policy over the frames learned from, each point marked with its success. Where no final
    error is known, as on a robot, successes stand at 1 and the others at 0."""
    known = [(trial, trial.final_error) for trial in trials if trial.final_error is not None]
    judged = known or [(trial, float(trial.success)) for trial in trials if trial.success is not None]
    if not judged:
        raise Failure("trials.csv has neither final error nor success in any row: there is nothing to draw")
    axes.plot([t.frames for t, _ in judged], [y for _, y in judged], color=GREY, linewidth=1, zorder=1)
    for success, marker, colour, label in ((True, "o", BLUE, "success"), (False, "X", VERMILLION, "no success"),
                                           (None, "D", GREY, "success not known")):
        points = [(t.frames, y) for t, y in judged if t.success is success]
        if points:
            axes.scatter(*zip(*points), marker=marker, s=70, color=colour, edgecolors="white", linewidths=0.8, zorder=2,
                         label=label)
    if not known:
        axes.set_ylim(-0.2, 1.2)
        axes.set_ylabel("success [-]")
        return
    axes.axhline(goal.tolerance, color=GREY, linewidth=1, linestyle="--", zorder=0)
    if goal.unit == "deg":
        axes.set_ylim(-6, 186)
        axes.set_yticks(sorted({0, goal.tolerance, 45, 90, 135, 180}))
    else:
        axes.set_ylim(bottom=0)
    axes.set_ylabel("distance from the goal at the end [%s]" % goal.unit.replace("deg", "°"))


def draw(options):
    with new_screen_figure(7.0, 4.2) as figure:
        axes = figure.subplots()
        draw_one(axes, read_trials(options.folder), read_goal(options.folder))
        axes.set_xlabel("frames learned from [image-torque pairs]")
        axes.set_xlim(left=0)
        axes.set_title("Greedy policy after each trial")
        axes.grid(True, color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.legend(loc="best")
        save(figure, options.out)


FIGURE = Figure("The final error after each trial of a run. Where none is known, as on a robot, the successes.",
                [argument("folder", metavar="DIR", help="run folder (it holds trials.csv)")], draw)
