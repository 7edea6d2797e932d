# Draws how the pendulum moves under the greedy policy after each trial, for many seeds: the paper's Fig. 7.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ddm_launch.figure_style import BLUE, PAGE_WIDTH, VERMILLION, new_figure, save, write
from ddm_launch.film_strip import SUCCESS_LIMIT_RAD, target_error
from ddm_launch.run_folder import RunFolderError, number, read_csv

COLUMNS = 5  # panels in a row
SETTLED_FRAMES = 10  # a success has this many last frames within SUCCESS_LIMIT_RAD
MOST_TURNS = 2.3  # the panels show at most +- this many half turns [pi rad]; few trajectories leave them
TARGET = "#c8c8c8"  # light enough that lines on it stand out


class Trajectory:
    """One greedy run: angle_rad[k], not wrapped, at time_s[k] after its start."""

    def __init__(self):
        self.time_s = []
        self.angle_rad = []

    @property
    def end_s(self):
        """When the last torque has acted."""
        last_step = self.time_s[-1] - self.time_s[-2] if len(self.time_s) > 1 else 0.0
        return self.time_s[-1] + last_step

    @property
    def settled(self):
        """Whether the rod stands up at the end, by the same measure as the success in trials.csv."""
        return all(target_error(angle) < SUCCESS_LIMIT_RAD for angle in self.angle_rad[-SETTLED_FRAMES:])


def read_trajectories(path):
    """All trajectories of a file, as {trial: {seed: Trajectory}}; both keys ascend."""
    rows = read_csv(path, ["seed", "trial", "step", "time_s", "angle_rad"], "collect the evaluations of a sweep first")
    keys = ["trial", "seed", "step", "time_s", "angle_rad"]
    trials, last = {}, None
    for trial, seed, step, time_s, angle_rad in sorted([number(row, key, path) for key in keys] for row in rows):
        if (trial, seed, step) == last:
            raise RunFolderError("%s holds step %d of trial %d of seed %d twice: give each run once" % (
                path, step, trial, seed))
        last = trial, seed, step
        trajectory = trials.setdefault(int(trial), {}).setdefault(int(seed), Trajectory())
        trajectory.time_s.append(time_s)
        trajectory.angle_rad.append(angle_rad)
    for trajectories in trials.values():
        for trajectory in trajectories.values():
            start = trajectory.time_s[0]
            trajectory.time_s = [time_s - start for time_s in trajectory.time_s]
    return trials


def half_turns_text(count):
    """An angle of so many half turns, as a label."""
    return {0: "0", 1: "$\\pi$", -1: "$-\\pi$"}.get(count, "$%d\\pi$" % count)


def draw_panel(axes, trajectories, trial):
    """All seeds after one trial, those that end upright drawn last; how many do stands in the corner."""
    for settled, colour, style, width in ((False, VERMILLION, (0, (3, 1)), 0.7), (True, BLUE, "-", 0.7)):
        for trajectory in trajectories.values():
            if trajectory.settled is settled:
                axes.plot(trajectory.time_s, [angle / math.pi for angle in trajectory.angle_rad], color=colour,
                          linestyle=style, linewidth=width, alpha=0.8)
    count = sum(trajectory.settled for trajectory in trajectories.values())
    axes.set_title("trial %d: %d of %d" % (trial, count, len(trajectories)), pad=3)


def draw_all(figure, trials):
    """One panel per trial, all with the same axes, and a legend below."""
    angles = [angle for panel in trials.values() for trajectory in panel.values() for angle in trajectory.angle_rad]
    reach = min(MOST_TURNS, max(1.3, 1.05 * max(abs(angle) for angle in angles) / math.pi))
    end = max(trajectory.end_s for panel in trials.values() for trajectory in panel.values())
    num_columns = min(COLUMNS, len(trials))
    num_rows = math.ceil(len(trials) / num_columns)
    grid = figure.add_gridspec(num_rows + 1, num_columns, height_ratios=[1.0] * num_rows + [0.001])
    for k, (trial, trajectories) in enumerate(trials.items()):
        row, column = divmod(k, num_columns)
        axes = figure.add_subplot(grid[row, column])
        for target in range(-3, 4, 2):  # all of them upright
            axes.axhspan(target - SUCCESS_LIMIT_RAD / math.pi, target + SUCCESS_LIMIT_RAD / math.pi, color=TARGET,
                         linewidth=0, zorder=0)
        draw_panel(axes, trajectories, trial)
        axes.set_xlim(0.0, round(end, 6))
        axes.set_ylim(-reach, reach)
        ticks = [count for count in range(-3, 4) if abs(count) < reach]
        axes.set_yticks(ticks)
        axes.set_yticklabels([half_turns_text(count) for count in ticks] if column == 0 else [])
        if column == 0:
            axes.set_ylabel("angle [rad]")
        if k + num_columns < len(trials):
            axes.set_xticklabels([])
        else:
            axes.set_xlabel("time [s]")
    legend = figure.add_subplot(grid[num_rows, :])
    legend.axis("off")
    legend.legend([Line2D([], [], color=BLUE), Line2D([], [], color=VERMILLION, linestyle=(0, (3, 1))),
                   Patch(color=TARGET)],
                  ["ends upright (counted above)", "does not", "target: within %.0f° of $\\pm\\pi$"
                   % math.degrees(SUCCESS_LIMIT_RAD)], loc="center", ncol=3, frameon=False)


def draw(path, out):
    """Draws the trajectories of a file into a picture file."""
    trials = read_trajectories(path)
    num_rows = math.ceil(len(trials) / COLUMNS)
    with new_figure(PAGE_WIDTH, 1.3 * num_rows + 0.6) as figure:
        draw_all(figure, trials)
        save(figure, out)


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="angle_trajectories",
        description="Draws the angle over time of greedy evaluations, one panel per trial in the file and all seeds in "
        "it. 'Ends upright' means: the last %d frames within %.0f degrees of +-pi, as 'success' in trials.csv; how "
        "many do stands above each panel. Angles count full turns; what lies beyond +-%.1f pi is cut off."
        % (SETTLED_FRAMES, math.degrees(SUCCESS_LIMIT_RAD), MOST_TURNS))
    parser.add_argument("file", metavar="FILE.csv", help="columns seed,trial,step,time_s,angle_rad")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("angle_trajectories", options.out, lambda out: draw(options.file, out))
