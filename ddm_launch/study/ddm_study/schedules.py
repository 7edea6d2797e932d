# Draws the training schedules side by side: success on the pendulum, prediction errors of pendulum and tile.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.averages import success_rates
from ddm_launch.figure_style import (BLUE, GREEN, GREY, PAGE_WIDTH, PURPLE, VERMILLION, Figure, add_legend, argument,
                                     new_figure, save)
from ddm_launch.run_folder import read_sweep
from ddm_study.results import SCHEDULES, late_success, predictions

# Label, colour, marker, line, and shift [frames] of its success, of each of SCHEDULES.
STYLES = (("joint", BLUE, "o", "-", -21),
          ("sequential", VERMILLION, "s", "--", -7),
          ("$V_P$ only", GREEN, "^", "-.", 7),
          ("joint, random start", PURPLE, "D", ":", 21))


def seeds_text(count):
    return "%d seed%s" % (count, "" if count == 1 else "s")


def draw_success(axes, folder):
    """Success rate over frames of the seeds that all schedules have, shifted so that no error bar covers another."""
    seeds = late_success(folder).index
    for name, (label, colour, marker, line, shift) in zip(SCHEDULES, STYLES):
        runs = read_sweep(os.path.join(folder, "" if name == "joint" else name, "trials.csv"))
        rows = success_rates(runs[seed] for seed in seeds)
        axes.errorbar([row[0] + shift for row in rows], [row[1] for row in rows], yerr=[row[2] for row in rows],
                      color=colour, marker=marker, linestyle=line, capsize=1.5, elinewidth=0.7, markersize=3,
                      label=label)
    axes.set_xlim(left=0)
    axes.set_ylim(-0.04, 1.04)
    axes.set_xlabel("frames learned from\n[image-torque pairs]")
    axes.set_ylabel("success rate [-]")
    axes.set_title("pendulum, control (%s)" % seeds_text(len(seeds)))


def draw_predictions(axes, folder, plant):
    """Prediction error over steps ahead, one line per schedule, and that of repeating the last frame."""
    errors = predictions(folder, plant)
    repeat = errors["rmse_repeat"]["joint"].groupby(level="steps").mean()
    axes.plot(repeat.index, repeat, color=GREY, linewidth=1.0, linestyle=(0, (1, 1)), marker="x", markersize=3,
              label="repeat the last frame", zorder=1)
    for name, (label, colour, marker, line, _) in zip(SCHEDULES, STYLES):
        groups = errors["rmse"][name].groupby(level="steps")
        axes.errorbar(repeat.index, groups.mean(), yerr=groups.sem(), color=colour, marker=marker, linestyle=line,
                      capsize=1.5, elinewidth=0.7, markersize=3, label=label)
    axes.set_xticks(repeat.index)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("steps ahead [-]")
    axes.set_ylabel("RMSE over pixels [grey]")
    axes.set_title("%s, prediction (%s)" % (plant, seeds_text(errors["rmse"].index.get_level_values("seed").nunique())))


def draw(options):
    with new_figure(PAGE_WIDTH, 2.5) as figure:
        grid = figure.add_gridspec(2, 3, height_ratios=[1.0, 0.001])
        panels = [figure.add_subplot(grid[0, column]) for column in range(3)]
        draw_success(panels[0], options.folder)
        for axes, plant in zip(panels[1:], ("pendulum", "tile")):
            draw_predictions(axes, options.folder, plant)
        for axes in panels:
            axes.grid(True)
        handles, labels = axes.get_legend_handles_labels()
        add_legend(figure, grid[1, :], handles[1:] + handles[:1], labels[1:] + labels[:1], ncol=5, handlelength=2.6)
        save(figure, options.out)


FIGURE = Figure(
    "Success by frames and prediction errors by steps of the training schedules. Means and standard errors over the seeds "
    "that all four have. Success is drawn a few frames to the left or right, so that no error bar covers another.",
    [argument("folder", metavar="DIR", help="results of the paper's experiments")], draw)
