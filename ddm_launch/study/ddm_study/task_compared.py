# Draws the mean return of a task over the physics frames learned from, next to published methods that learn from pixels.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_launch.command import Failure
from ddm_launch.figure_style import COLUMN_WIDTH, METHOD_STYLES, add_legend, new_figure, panel_above_legend, save
from ddm_launch.tables import optional, read_csv
from ddm_study.efficient_tables import REMEDY, SUITE

ABOUT = ("Mean return of a task of the DeepMind Control Suite over the physics frames learned from, with its standard "
         "error, next to published methods. Those are given a reward, ours a picture of the goal and a planner at run "
         "time.")
OURS = "efficient"
PUBLISHED = "it is results/published/suite_returns.csv of ddm_launch"
# The published methods that are drawn: at most four, the same for each task. The others are in the published table.
DRAWN = ("MR.Q", "DreamerV3", "DrQ-v2", "Dreamer v1")
MARKER_DISTANCE = 0.12  # along a curve, of the diagonal of the axes


def read_ours(path, task):
    """[physics frames], [mean return], [its standard error] of a task in a tasks.csv."""
    columns = {"task": str, "physics_frames": optional(float), "mean_return": optional(float),
               "return_se": optional(float)}
    rows = [row for row in read_csv(path, columns, REMEDY) if row["task"] == task and row["mean_return"] is not None]
    if not rows:
        raise Failure("%s has no return of the task %s: make it with reproduce_efficient --only tasks" % (path, task))
    return tuple([row[name] for row in rows] for name in ("physics_frames", "mean_return", "return_se"))


def read_published(path, task):
    """{method: ([physics frames], [mean return])} of DRAWN."""
    curves = {}
    for row in read_csv(path, {"task": str, "method": str, "physics_frames": float, "mean_return": float}, PUBLISHED):
        if row["task"] == task and row["method"] in DRAWN:
            frames, returns = curves.setdefault(row["method"], ([], []))
            frames.append(row["physics_frames"])
            returns.append(row["mean_return"])
    return curves


def draw_curves(axes, ours, published, step_s):
    """Ours on top; robot time on the upper edge. step_s: of a physics frame [s]."""
    for method, (frames, returns) in published.items():
        colour, marker = METHOD_STYLES[method]
        axes.plot(frames, returns, color=colour, marker=marker, markevery=MARKER_DISTANCE, linewidth=0.9, label=method)
    frames, returns, errors = ours
    colour, marker = METHOD_STYLES[OURS]
    axes.errorbar(frames, returns, yerr=errors, color=colour, marker=marker, capsize=2, elinewidth=0.8, zorder=5, label=OURS)
    axes.set_xscale("log")
    axes.set_ylim(bottom=-20)
    axes.set_xlabel("physics frames learned from [-]")
    axes.set_ylabel("mean return of an episode [-]")
    axes.grid(True)
    axes.secondary_xaxis("top", functions=(lambda frames: frames * step_s, lambda time: time / step_s)).set_xlabel(
        "robot time [s]")


def add_arguments(parser):
    parser.add_argument("table", metavar="FILE.csv", help="tasks.csv of reproduce_efficient")
    parser.add_argument("--task", required=True, choices=sorted(SUITE), help="a plant of that table")
    parser.add_argument("--published", required=True, metavar="FILE.csv", help=PUBLISHED)


def draw(options):
    task = SUITE[options.task]
    published = read_published(options.published, task.name)
    with new_figure(COLUMN_WIDTH, 3.4) as figure:
        axes, place = panel_above_legend(figure)
        draw_curves(axes, read_ours(options.table, options.task), published, task.step_s)
        handles, labels = axes.get_legend_handles_labels()
        add_legend(figure, place, handles[-1:] + handles[:-1], labels[-1:] + labels[:-1], ncol=3, columnspacing=1.2)
        save(figure, options.out)
