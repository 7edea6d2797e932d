# Draws how the pendulum moves under the greedy policy after each trial, for many seeds: the paper's Fig. 7.
# SPDX-License-Identifier: BSD-3-Clause
import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ddm_launch.figure_style import BLUE, PAGE_WIDTH, VERMILLION, add_legend, new_figure, save
from ddm_launch.film_strip import SUCCESS_LIMIT_RAD
from ddm_launch.tables import read_csv

ABOUT = ("The angle over time in greedy evaluations. One panel per number of frames learned from and all seeds in it; how "
         "many succeed is written above each panel. Angles count full turns; what lies beyond the panels is cut off.")
COLUMNS = 5  # panels in a row
MOST_TURNS = 2.3  # the panels show at most +- this many half turns [pi rad]; few trajectories leave them
TARGET = "#c8c8c8"  # light enough that lines on it stand out


class Trajectory:
    """One greedy run: angle_rad[k], not wrapped, at time_s[k] after its start; success as in trials.csv."""

    def __init__(self, success):
        self.success = success
        self.time_s = []
        self.angle_rad = []

    @property
    def end_s(self):
        """When the last torque has acted."""
        last_step = self.time_s[-1] - self.time_s[-2] if len(self.time_s) > 1 else 0.0
        return self.time_s[-1] + last_step


def read_trajectories(path):
    """All trajectories of a file, as {frames learned from: {seed: Trajectory}}; both keys ascend."""
    keys = {"frames": int, "seed": int, "step": int, "time_s": float, "angle_rad": float, "success": float}
    rows = read_csv(path, keys, "rosrun ddm_launch reproduce_paper writes it", once=("seed", "frames", "step"))
    trials = {}
    for row in sorted(rows, key=lambda row: (row["frames"], row["seed"], row["step"])):
        of_trial = trials.setdefault(row["frames"], {})
        trajectory = of_trial.setdefault(row["seed"], Trajectory(row["success"] > 0.5))
        trajectory.time_s.append(row["time_s"])
        trajectory.angle_rad.append(row["angle_rad"])
    for trajectories in trials.values():
        for trajectory in trajectories.values():
            start = trajectory.time_s[0]
            trajectory.time_s = [time_s - start for time_s in trajectory.time_s]
    return trials


def half_turns_text(count):
    """An angle of so many half turns, as a label."""
    return {0: "0", 1: "$\\pi$", -1: "$-\\pi$"}.get(count, "$%d\\pi$" % count)


def angle_reach(angles):
    """Up to how many half turns [pi rad] panels with these angles show: the target always, at most MOST_TURNS."""
    return min(MOST_TURNS, max(1.3, 1.05 * max(abs(angle) for angle in angles) / math.pi))


def set_angle_axis(axes, reach, labelled):
    """The vertical axis of a panel in half turns, with all targets; its labels only where asked for."""
    for target in range(-3, 4, 2):  # all of them upright
        axes.axhspan(target - SUCCESS_LIMIT_RAD / math.pi, target + SUCCESS_LIMIT_RAD / math.pi, color=TARGET,
                     linewidth=0, zorder=0)
    axes.set_ylim(-reach, reach)
    ticks = [count for count in range(-3, 4) if abs(count) < reach]
    axes.set_yticks(ticks)
    axes.set_yticklabels([half_turns_text(count) for count in ticks] if labelled else [])


def target_handle():
    """(handle, label) of the targets in a legend."""
    return Patch(color=TARGET), "target: within %.0f° of $\\pm\\pi$" % math.degrees(SUCCESS_LIMIT_RAD)


def draw_panel(axes, trajectories, frames):
    """All seeds after so many frames, those that succeed drawn last; how many do is written above."""
    for success, colour, style, width in ((False, VERMILLION, (0, (3, 1)), 0.7), (True, BLUE, "-", 0.7)):
        for trajectory in trajectories.values():
            if trajectory.success is success:
                axes.plot(trajectory.time_s, [angle / math.pi for angle in trajectory.angle_rad], color=colour,
                          linestyle=style, linewidth=width, alpha=0.8)
    count = sum(trajectory.success for trajectory in trajectories.values())
    axes.set_title("%d frames: %d of %d" % (frames, count, len(trajectories)), pad=3)


def draw_all(figure, trials):
    """One panel per trial, all with the same axes, and a legend below."""
    reach = angle_reach(angle for panel in trials.values() for trajectory in panel.values()
                        for angle in trajectory.angle_rad)
    end = max(trajectory.end_s for panel in trials.values() for trajectory in panel.values())
    num_columns = min(COLUMNS, len(trials))
    num_rows = math.ceil(len(trials) / num_columns)
    grid = figure.add_gridspec(num_rows + 1, num_columns, height_ratios=[1.0] * num_rows + [0.001])
    for k, (frames, trajectories) in enumerate(trials.items()):
        row, column = divmod(k, num_columns)
        axes = figure.add_subplot(grid[row, column])
        set_angle_axis(axes, reach, column == 0)
        draw_panel(axes, trajectories, frames)
        axes.set_xlim(0.0, round(end, 6))
        if column == 0:
            axes.set_ylabel("angle [rad]")
        if k + num_columns < len(trials):
            axes.set_xticklabels([])
        else:
            axes.set_xlabel("time [s]")
    target, target_label = target_handle()
    add_legend(figure, grid[num_rows, :],
               [Line2D([], [], color=BLUE), Line2D([], [], color=VERMILLION, linestyle=(0, (3, 1))), target],
               ["success (counted above)", "none", target_label], ncol=3)


def add_arguments(parser):
    parser.add_argument("file", metavar="FILE.csv", help="columns seed,frames,success,step,time_s,angle_rad")


def draw(options):
    trials = read_trajectories(options.file)
    with new_figure(PAGE_WIDTH, 1.3 * math.ceil(len(trials) / COLUMNS) + 0.6) as figure:
        draw_all(figure, trials)
        save(figure, options.out)
