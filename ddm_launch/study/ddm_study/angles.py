# Draws how the pendulum's angle moves: in greedy evaluations (the paper's Fig. 7), and as PILCO predicted it.
# SPDX-License-Identifier: BSD-3-Clause
import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from ddm_launch.command import number
from ddm_launch.figure_style import (BLUE, ORANGE, PAGE_WIDTH, SKY, VERMILLION, Figure, add_legend, argument, new_figure,
                                     save)
from ddm_study.results import read_table

COLUMNS = 5  # panels in a row
SUCCESS_LIMIT_RAD = math.radians(10.0)
MOST_TURNS = 2.3  # the panels show at most +- this many half turns [pi rad]; few trajectories leave them
TARGET = "#c8c8c8"  # light enough that lines on it stand out
STYLES = {0: (VERMILLION, (0, (3, 1))), 1: (BLUE, "-")}  # success: colour, line; those that succeed are on top
NUM_DEVIATIONS = 2.0  # half the width of the band [standard deviations]
# Kind of actual run: colour, line, label.
ACTUAL = {"evaluation": (VERMILLION, "-", "evaluation"), "trial": (ORANGE, (0, (3, 1)), "next recorded trial")}


def half_turns_text(count):
    """An angle of so many half turns, as a label."""
    return {0: "0", 1: "$\\pi$", -1: "$-\\pi$"}.get(count, "$%d\\pi$" % count)


def angle_panels(figure, num_rows, num_columns, count, largest, end_s):
    """(axes of so many panels over time, the place for a legend below them). Angles are in half turns [pi rad], up to the
    largest or MOST_TURNS, with all targets; axes are labelled where no panel is to the left or below."""
    grid = figure.add_gridspec(num_rows + 1, num_columns, height_ratios=[1.0] * num_rows + [0.001])
    reach = min(MOST_TURNS, max(1.3, 1.05 * largest))
    ticks = [turns for turns in range(-3, 4) if abs(turns) < reach]
    panels = [figure.add_subplot(grid[divmod(k, num_columns)]) for k in range(count)]
    for k, axes in enumerate(panels):
        for target in range(-3, 4, 2):  # all of them upright
            axes.axhspan(target - SUCCESS_LIMIT_RAD / math.pi, target + SUCCESS_LIMIT_RAD / math.pi, color=TARGET,
                         linewidth=0, zorder=0)
        axes.set_xlim(0.0, end_s)
        axes.set_ylim(-reach, reach)
        axes.set_yticks(ticks)
        axes.set_yticklabels([] if k % num_columns else [half_turns_text(turns) for turns in ticks])
        if k % num_columns == 0:
            axes.set_ylabel("angle [rad]")
        if k + num_columns < count:
            axes.tick_params(labelbottom=False)
        else:
            axes.set_xlabel("time [s]")
    target = Patch(color=TARGET), "target: within %.0f° of $\\pm\\pi$" % math.degrees(SUCCESS_LIMIT_RAD)
    return panels, grid[num_rows, :], target


def draw_trajectories(options):
    """One panel for each number of frames, all with the same axes, and a legend below."""
    table = read_table(options.file)
    table["turns"] = table.angle_rad / math.pi
    panels_of = list(table.groupby("frames"))
    num_columns = min(COLUMNS, len(panels_of))
    num_rows = math.ceil(len(panels_of) / num_columns)
    with new_figure(PAGE_WIDTH, 1.3 * num_rows + 0.6) as figure:
        panels, place, target = angle_panels(figure, num_rows, num_columns, len(panels_of), table.turns.abs().max(),
                                             table.time_s.max() + table.time_s[1] - table.time_s[0])
        for axes, (frames, of_frames) in zip(panels, panels_of):
            for success, (colour, style) in STYLES.items():
                for _, run in of_frames[of_frames.success == success].groupby("seed"):
                    axes.plot(run.time_s, run.turns, color=colour, linestyle=style, linewidth=0.7, alpha=0.8)
            by_seed = of_frames.groupby("seed").success.first()
            axes.set_title("%d frames: %d of %d" % (frames, by_seed.sum(), len(by_seed)), pad=3)
        handles = [Line2D([], [], color=colour, linestyle=style) for colour, style in (STYLES[1], STYLES[0])]
        add_legend(figure, place, handles + [target[0]], ["success (counted above)", "failure", target[1]], ncol=3)
        save(figure, options.out)


def draw_distributions(options):
    """One row for each seed, one column for each number of frames, all with the same axes, and a legend below."""
    table = read_table(options.file)
    end_s = options.seconds or table.time_s.max()
    table = table[table.time_s <= end_s].assign(
        turns=table.angle_rad / math.pi, half=NUM_DEVIATIONS * table.angle_std_rad.fillna(0.0) / math.pi)
    seeds, columns = sorted(set(table.seed)), sorted(set(table.frames))
    with new_figure(PAGE_WIDTH, 1.15 * len(seeds) + 0.6) as figure:
        panels, place, target = angle_panels(figure, len(seeds), len(columns), len(seeds) * len(columns),
                                             (table.turns.abs() + table.half).max(), end_s)
        for k, axes in enumerate(panels):
            seed, frames = seeds[k // len(columns)], columns[k % len(columns)]
            policy = table[(table.seed == seed) & (table.frames == frames)]
            predicted = policy[policy.kind == "predicted"]
            axes.fill_between(predicted.time_s, predicted.turns - predicted.half, predicted.turns + predicted.half,
                              color=SKY, alpha=0.5, linewidth=0)
            axes.plot(predicted.time_s, predicted.turns, color=BLUE, linewidth=0.8)
            for kind, (colour, line, _) in ACTUAL.items():
                run = policy[policy.kind == kind]
                axes.plot(run.time_s, run.turns, color=colour, linestyle=line, linewidth=0.7)
            axes.xaxis.set_major_locator(MaxNLocator(nbins=3, steps=[1, 2, 5, 10]))
            if k % len(columns) == 0:
                axes.set_ylabel("seed %d\nangle [rad]" % seed)
            if k < len(columns):
                axes.set_title("%d frames" % frames, pad=3)
        handles = [(Line2D([], [], color=BLUE), "predicted mean"),
                   (Patch(color=SKY, alpha=0.5), "$\\pm %g\\sigma$" % NUM_DEVIATIONS)]
        handles += [(Line2D([], [], color=colour, linestyle=line), label) for colour, line, label in ACTUAL.values()]
        add_legend(figure, place, *zip(*handles, target), ncol=len(handles) + 1, columnspacing=1.2)
        save(figure, options.out)


TRAJECTORIES = Figure(
    "The angle over time in greedy evaluations. One panel per number of frames learned from and all seeds in it; how many "
    "succeed is written above each panel. Angles count full turns; what lies beyond the panels is cut off.",
    [argument("file", metavar="FILE.csv", help="columns seed,frames,success,step,time_s,angle_rad")], draw_trajectories)
DISTRIBUTIONS = Figure(
    "The angle that PILCO predicted for each policy, and what that policy did. The distribution when the policy was "
    "learned, and two actual runs, the greedy evaluation and the next recorded trial; one row per seed, one column per "
    "number of frames learned from.",
    [argument("file", metavar="FILE.csv", help="columns seed,trial,frames,kind,step,time_s,angle_rad,angle_std_rad"),
     argument("--seconds", metavar="S", type=number(float, 0.1), help="draw only the first S; default all")],
    draw_distributions)
