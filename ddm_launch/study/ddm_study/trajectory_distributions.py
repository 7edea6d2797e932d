# Draws the distribution of the angle that PILCO predicted for each policy, and what that policy did.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from ddm_launch.command import Failure
from ddm_launch.figure_style import BLUE, ORANGE, PAGE_WIDTH, SKY, VERMILLION, add_legend, new_figure, save
from ddm_launch.tables import optional, read_csv
from ddm_study.angle_trajectories import angle_panels, angle_reach, half_turns, target_handle
from ddm_study.pilco_runs import DISTRIBUTION_COLUMNS, EVALUATION, PREDICTED, TRIAL

ABOUT = ("The angle that PILCO predicted for each policy, and what that policy did. The distribution when the policy was "
         "learned, and two actual runs, the greedy evaluation and the next recorded trial; one row per seed, one column "
         "per number of frames learned from.")
NUM_DEVIATIONS = 2.0  # half the width of the band [standard deviations]
KINDS = (PREDICTED, EVALUATION, TRIAL)
# Kind of actual run, colour, line, label.
ACTUAL = ((EVALUATION, VERMILLION, "-", "evaluation"), (TRIAL, ORANGE, (0, (3, 1)), "next recorded trial"))


class Angles:
    """One predicted or actual course of the angle; deviation_rad is 0 of an actual one."""

    def __init__(self):
        self.time_s, self.angle_rad, self.deviation_rad = [], [], []

    def edge(self, sign):
        """The upper (1) or lower (-1) edge of the band [rad]."""
        return [angle + sign * NUM_DEVIATIONS * deviation
                for angle, deviation in zip(self.angle_rad, self.deviation_rad)]


def read_distributions(path):
    """All of a file, as {seed: {frames learned from: {kind: Angles}}}, in ascending order."""
    columns = {"seed": int, "trial": int, "frames": int, "kind": str, "step": int, "time_s": float, "angle_rad": float,
               "angle_std_rad": optional(float)}
    names, seeds = ("seed", "frames", "kind", "step"), {}
    rows = read_csv(path, columns, "rosrun ddm_launch reproduce_paper writes it", once=names)
    for row in sorted(rows, key=lambda row: [row[name] for name in names]):
        kind, deviation_rad = row["kind"], row["angle_std_rad"]
        if kind not in KINDS:
            raise Failure("%s: column kind must hold one of %s, got '%s'" % (path, ", ".join(KINDS), kind))
        if kind == PREDICTED and (deviation_rad is None or deviation_rad < 0.0):
            raise Failure("%s: column angle_std_rad must be >= 0, got %s" % (path, deviation_rad))
        angles = seeds.setdefault(row["seed"], {}).setdefault(row["frames"], {}).setdefault(kind, Angles())
        angles.time_s.append(row["time_s"])
        angles.angle_rad.append(row["angle_rad"])
        angles.deviation_rad.append(deviation_rad if kind == PREDICTED else 0.0)
    return seeds


def draw_policy(axes, runs):
    """Prediction and actual runs of one policy. runs: {kind: Angles}."""
    predicted = runs.get(PREDICTED)
    if predicted:
        axes.fill_between(predicted.time_s, half_turns(predicted.edge(-1)), half_turns(predicted.edge(1)), color=SKY,
                          alpha=0.5, linewidth=0)
        axes.plot(predicted.time_s, half_turns(predicted.angle_rad), color=BLUE, linewidth=0.8)
    for kind, colour, line, _ in ACTUAL:
        if kind in runs:
            axes.plot(runs[kind].time_s, half_turns(runs[kind].angle_rad), color=colour, linestyle=line, linewidth=0.7)


def draw_all(figure, seeds, seconds):
    """One row per seed, one column per number of frames, all with the same axes, and a legend below.

    seconds: where the axes end; None: with the longest run.
    """
    columns = sorted({frames for policies in seeds.values() for frames in policies})
    runs = [run for policies in seeds.values() for kinds in policies.values() for run in kinds.values()]
    end_s = seconds or max(run.time_s[-1] for run in runs)
    reach = angle_reach(edge for run in runs for sign in (-1, 1)
                        for time_s, edge in zip(run.time_s, run.edge(sign)) if time_s <= end_s)
    panels, place = angle_panels(figure, len(seeds), len(columns), len(seeds) * len(columns), reach, end_s)
    for k, axes in enumerate(panels):
        seed, frames = list(seeds)[k // len(columns)], columns[k % len(columns)]
        draw_policy(axes, seeds[seed].get(frames, {}))
        axes.xaxis.set_major_locator(MaxNLocator(nbins=3, steps=[1, 2, 5, 10]))
        if k % len(columns) == 0:
            axes.set_ylabel("seed %d\nangle [rad]" % seed)
        if k < len(columns):
            axes.set_title("%d frames" % frames, pad=3)
    handles = [(Line2D([], [], color=BLUE), "predicted mean"),
               (Patch(color=SKY, alpha=0.5), "$\\pm %g\\sigma$" % NUM_DEVIATIONS)]
    handles += [(Line2D([], [], color=colour, linestyle=line), label) for _, colour, line, label in ACTUAL]
    handles.append(target_handle())
    add_legend(figure, place, *zip(*handles), ncol=len(handles), columnspacing=1.2)


def positive_seconds(text):
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds < math.inf:
        raise argparse.ArgumentTypeError("must be a time > 0 [s], got '%s'" % text)
    return seconds


def add_arguments(parser):
    parser.add_argument("file", metavar="FILE.csv", help="columns " + ",".join(DISTRIBUTION_COLUMNS))
    parser.add_argument("--seconds", metavar="S", type=positive_seconds, help="draw only the first S; default all")


def draw(options):
    seeds = read_distributions(options.file)
    with new_figure(PAGE_WIDTH, 1.15 * len(seeds) + 0.6) as figure:
        draw_all(figure, seeds, options.seconds)
        save(figure, options.out)
