# Draws the mean return of a task over the physics frames learned from, next to published methods that learn from pixels.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.command import package_path
from ddm_launch.figure_style import (COLUMN_WIDTH, METHOD_STYLES, Figure, add_legend, argument, new_figure,
                                     panel_above_legend, save)
from ddm_study.results import SUITE, read_table, returns

OURS = "efficient"
# The published methods that are drawn: at most four, the same for each task. The others are in the published table.
DRAWN = ("MR.Q", "DreamerV3", "DrQ-v2", "Dreamer v1")
MARKER_DISTANCE = 0.12  # along a curve, of the diagonal of the axes


def draw(options):
    """Ours on top; robot time on the upper edge."""
    task, step_s = SUITE[options.task]
    published = read_table(package_path("results", "published", "suite_returns.csv"))
    ours = returns(options.table)
    with new_figure(COLUMN_WIDTH, 3.4) as figure:
        axes, place = panel_above_legend(figure)
        colour, marker = METHOD_STYLES[OURS]
        axes.errorbar(ours.physics_frames, ours["mean"], yerr=ours.se, color=colour, marker=marker, capsize=2,
                      elinewidth=0.8, zorder=5, label=OURS)
        for method, rows in published[published.task == task].groupby("method", sort=False):
            if method in DRAWN:
                colour, marker = METHOD_STYLES[method]
                axes.plot(rows.physics_frames, rows.mean_return, color=colour, marker=marker, markevery=MARKER_DISTANCE,
                          linewidth=0.9, label=method)
        axes.set_xscale("log")
        axes.set_ylim(bottom=-20)
        axes.set_xlabel("physics frames learned from [-]")
        axes.set_ylabel("mean return of an episode [-]")
        axes.grid(True)
        axes.secondary_xaxis("top", functions=(lambda frames: frames * step_s, lambda time: time / step_s)).set_xlabel(
            "robot time [s]")
        handles, labels = axes.get_legend_handles_labels()
        ours_first = sorted(zip(labels, handles), key=lambda pair: pair[0] != OURS)
        add_legend(figure, place, [handle for _, handle in ours_first], [label for label, _ in ours_first], ncol=3,
                   columnspacing=1.2)
        save(figure, options.out)


FIGURE = Figure(
    "Mean return of a task of the DeepMind Control Suite over the physics frames learned from, with its standard error, "
    "next to published methods. Those are given a reward, ours a picture of the goal and a planner at run time.",
    [argument("table", metavar="FILE.csv", help="trials.csv of the task"),
     argument("--task", required=True, choices=sorted(SUITE), help="plant of that table")], draw)
