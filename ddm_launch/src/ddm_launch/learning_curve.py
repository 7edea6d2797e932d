# Draws the learning curve of an experiment: the final error after each trial.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.command import Failure
from ddm_launch.figure_style import BLUE, GREY, VERMILLION, Figure, argument, new_screen_figure, save
from ddm_launch.run_folder import read_setting, read_trials


def draw_one(axes, folder):
    """Draws the final error of the evaluations over the number of frames learned from. Markers distinguish successes
    from failures. If no final error is known, as on a robot, draws successes at 1 and failures at 0.

    Raises Failure if neither final errors nor successes are known.
    """
    trials = read_trials(os.path.join(folder, "trials.csv"))
    unit = read_setting(folder, "goal", "error_unit", "unit of the final error")
    tolerance = float(read_setting(folder, "goal", "tolerance", "largest error that counts as success"))
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
        axes.set_ylabel("success [-]")
        return
    axes.axhline(tolerance, color=GREY, linewidth=1, linestyle="--", zorder=0)
    axes.set_ylim(bottom=0)
    if unit == "deg":
        axes.set_ylim(-6, 186)
        axes.set_yticks(sorted({0, tolerance, 45, 90, 135, 180}))
    axes.set_ylabel("distance from the goal at the end [%s]" % unit.replace("deg", "°"))


def draw(options):
    with new_screen_figure(7.0, 4.2) as figure:
        axes = figure.subplots()
        draw_one(axes, options.folder)
        axes.set_xlabel("frames learned from [image-torque pairs]")
        axes.set_xlim(left=0)
        axes.set_title("Greedy policy after each trial")
        axes.grid(True, color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.legend(loc="best")
        save(figure, options.out)


FIGURE = Figure("The final error after each trial of a run. Where none is known, as on a robot, the successes.",
                [argument("folder", metavar="DIR", help="run folder (it holds trials.csv)")], draw)
