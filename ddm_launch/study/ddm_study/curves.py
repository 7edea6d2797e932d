# Draws angles over time in evaluations (as in the paper's Fig. 7), and returns of tasks over robot time.
# SPDX-License-Identifier: BSD-3-Clause
import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ddm_launch.command import package_path
from ddm_launch.figure_style import (BLUE, COLUMN_WIDTH, METHOD_STYLES, PAGE_WIDTH, VERMILLION, Figure, add_legend, argument,
                                     new_figure, panel_above_legend, save)
from ddm_study.results import PHYSICS_FRAMES, SUITE, read_table, returns

COLUMNS = 5  # panels per row
SUCCESS_LIMIT = 10.0 / 180.0  # [half turns]
MOST_TURNS = 2.3  # largest angle in the panels [half turns of pi rad]; few trajectories exceed it
TARGET = "#c8c8c8"  # light, so that lines stand out
STYLES = {0: (VERMILLION, (0, (3, 1))), 1: (BLUE, "-")}  # success: colour and line style; successes are drawn last

OURS = "DDM"
# Published methods in the figures: the same for each task, at most four. The table of published returns has further
# methods.
DRAWN = ("MR.Q", "DreamerV3", "DrQ-v2", "Dreamer v1")
MARKER_DISTANCE = 0.12  # distance between markers along a curve, in diagonals of the axes


def draw_trajectories(options):
    table = read_table(options.file)
    table["turns"] = table.angle_rad / math.pi
    panels = list(table.groupby("frames"))
    num_columns = min(COLUMNS, len(panels))
    num_rows = math.ceil(len(panels) / num_columns)
    reach = min(MOST_TURNS, max(1.3, 1.05 * table.turns.abs().max()))
    ticks = [turns for turns in range(-3, 4) if abs(turns) < reach]
    labels = ["0" if turns == 0 else ("$%d\\pi$" % turns).replace("1", "") for turns in ticks]
    with new_figure(PAGE_WIDTH, 1.3 * num_rows + 0.6) as figure:
        grid = figure.add_gridspec(num_rows + 1, num_columns, height_ratios=[1.0] * num_rows + [0.001])
        for k, (frames, of_frames) in enumerate(panels):
            axes = figure.add_subplot(grid[divmod(k, num_columns)])
            # The pendulum is upright at each of these angles.
            for target in range(-3, 4, 2):
                axes.axhspan(target - SUCCESS_LIMIT, target + SUCCESS_LIMIT, color=TARGET, linewidth=0, zorder=0)
            for success, (colour, style) in STYLES.items():
                for _, run in of_frames[of_frames.success == success].groupby("seed"):
                    axes.plot(run.time_s, run.turns, color=colour, linestyle=style, linewidth=0.7, alpha=0.8)
            by_seed = of_frames.groupby("seed").success.first()
            axes.set_title("%d frames: %d of %d" % (frames, by_seed.sum(), len(by_seed)), pad=3)
            axes.set(xlim=(0.0, table.time_s.max() + table.time_s[1] - table.time_s[0]), ylim=(-reach, reach), yticks=ticks,
                     yticklabels=[] if k % num_columns else labels, ylabel="" if k % num_columns else "angle [rad]")
            is_last = k + num_columns >= len(panels)
            axes.tick_params(labelbottom=is_last)
            axes.set_xlabel("time [s]" if is_last else "")
        handles = [Line2D([], [], color=colour, linestyle=style) for colour, style in (STYLES[1], STYLES[0])]
        add_legend(figure, grid[num_rows, :], handles + [Patch(color=TARGET)],
                   ["success (counted above)", "failure", "target: within 10° of $\\pm\\pi$"], ncol=3)
        save(figure, options.out)


def draw_task(options):
    task, step_s = SUITE[options.task]
    published = read_table(package_path("results", "published", "suite_returns.csv"))
    ours = returns(options.table)
    with new_figure(COLUMN_WIDTH, 3.4) as figure:
        axes, place = panel_above_legend(figure)
        colour, marker = METHOD_STYLES["efficient"]
        axes.errorbar(PHYSICS_FRAMES * ours.index, ours["mean"], yerr=ours.se, color=colour, marker=marker, capsize=2,
                      elinewidth=0.8, zorder=5, label=OURS)
        for method, rows in published[published.task == task].groupby("method", sort=False):
            if method in DRAWN:
                colour, marker = METHOD_STYLES[method]
                axes.plot(rows.physics_frames, rows.mean_return, color=colour, marker=marker, markevery=MARKER_DISTANCE,
                          linewidth=0.9, label=method)
        axes.set_xscale("log")
        axes.set_ylim(bottom=-20)
        axes.set_xlabel("physics frames learned from")
        axes.set_ylabel("mean return of an episode")
        axes.grid(True)
        axes.secondary_xaxis("top", functions=(lambda frames: frames * step_s, lambda time: time / step_s)).set_xlabel(
            "robot time [s]")
        handles, labels = axes.get_legend_handles_labels()
        ours_first = sorted(zip(labels, handles), key=lambda pair: pair[0] != OURS)
        add_legend(figure, place, [handle for _, handle in ours_first], [label for label, _ in ours_first], ncol=3,
                   columnspacing=1.2)
        save(figure, options.out)


TRAJECTORIES = Figure(
    "The angle over time in greedy evaluations. One panel per number of frames learned from and all seeds in it; how many "
    "succeed is written above each panel. Angles count full turns; what lies beyond the panels is cut off.",
    [argument("file", metavar="FILE.csv", help="columns seed,frames,success,step,time_s,angle_rad")], draw_trajectories)
TASK = Figure(
    "Mean return of a task of the DeepMind Control Suite over the physics frames learned from, with its standard error, "
    "next to published methods. Those are given a reward, ours an image of the goal and a planner at run time.",
    [argument("table", metavar="FILE.csv", help="trials.csv of the task"),
     argument("--task", required=True, choices=sorted(SUITE), help="plant of that table")], draw_task)
