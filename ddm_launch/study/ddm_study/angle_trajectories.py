# Draws how the pendulum moves under the greedy policy after each trial, for many seeds: the paper's Fig. 7.
# SPDX-License-Identifier: BSD-3-Clause
import math

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ddm_launch.figure_style import BLUE, PAGE_WIDTH, VERMILLION, add_legend, new_figure, save
from ddm_launch.tables import read_csv

ABOUT = ("The angle over time in greedy evaluations. One panel per number of frames learned from and all seeds in it; how "
         "many succeed is written above each panel. Angles count full turns; what lies beyond the panels is cut off.")
COLUMNS = 5  # panels in a row
SUCCESS_LIMIT_RAD = math.radians(10.0)
MOST_TURNS = 2.3  # the panels show at most +- this many half turns [pi rad]; few trajectories leave them
TARGET = "#c8c8c8"  # light enough that lines on it stand out
STYLES = {False: (VERMILLION, (0, (3, 1))), True: (BLUE, "-")}  # success: colour, line; those that succeed are on top


class Trajectory:
    """One greedy run: angle_rad[k], not wrapped, at time_s[k] after its start; success as in trials.csv."""

    def __init__(self, success):
        self.success = success
        self.time_s, self.angle_rad = [], []

    @property
    def end_s(self):
        """When the last torque has acted."""
        return self.time_s[-1] + (self.time_s[-1] - self.time_s[-2] if len(self.time_s) > 1 else 0.0)


def read_trajectories(path):
    """All trajectories of a file, as {frames learned from: {seed: Trajectory}}; both keys ascend."""
    keys = {"frames": int, "seed": int, "step": int, "time_s": float, "angle_rad": float, "success": float}
    rows = read_csv(path, keys, "rosrun ddm_launch reproduce_paper writes it", once=("seed", "frames", "step"))
    trials, start_s = {}, 0.0
    for row in sorted(rows, key=lambda row: (row["frames"], row["seed"], row["step"])):
        trajectory = trials.setdefault(row["frames"], {}).setdefault(row["seed"], Trajectory(row["success"] > 0.5))
        if not trajectory.time_s:
            start_s = row["time_s"]
        trajectory.time_s.append(row["time_s"] - start_s)
        trajectory.angle_rad.append(row["angle_rad"])
    return trials


def half_turns(angles_rad):
    return [angle / math.pi for angle in angles_rad]


def half_turns_text(count):
    """An angle of so many half turns, as a label."""
    return {0: "0", 1: "$\\pi$", -1: "$-\\pi$"}.get(count, "$%d\\pi$" % count)


def angle_reach(angles):
    """Up to how many half turns [pi rad] panels with these angles show: the target always, at most MOST_TURNS."""
    return min(MOST_TURNS, max(1.3, 1.05 * max(abs(angle) for angle in angles) / math.pi))


def angle_panels(figure, num_rows, num_columns, count, reach, end_s):
    """(axes of so many panels over time, the place for a legend below them). Angles are in half turns, with all targets;
    axes are labelled where no panel is to the left or below."""
    grid = figure.add_gridspec(num_rows + 1, num_columns, height_ratios=[1.0] * num_rows + [0.001])
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
    return panels, grid[num_rows, :]


def target_handle():
    """(handle, label) of the targets in a legend."""
    return Patch(color=TARGET), "target: within %.0f° of $\\pm\\pi$" % math.degrees(SUCCESS_LIMIT_RAD)


def draw_all(figure, trials):
    """One panel per trial, all with the same axes, and a legend below."""
    runs = [run for panel in trials.values() for run in panel.values()]
    num_columns = min(COLUMNS, len(trials))
    panels, place = angle_panels(figure, math.ceil(len(trials) / num_columns), num_columns, len(trials),
                                 angle_reach(angle for run in runs for angle in run.angle_rad),
                                 round(max(run.end_s for run in runs), 6))
    for axes, (frames, of_seeds) in zip(panels, trials.items()):
        for run in sorted(of_seeds.values(), key=lambda run: run.success):
            colour, style = STYLES[run.success]
            axes.plot(run.time_s, half_turns(run.angle_rad), color=colour, linestyle=style, linewidth=0.7, alpha=0.8)
        axes.set_title("%d frames: %d of %d" % (frames, sum(run.success for run in of_seeds.values()), len(of_seeds)),
                       pad=3)
    target, target_label = target_handle()
    add_legend(figure, place, [Line2D([], [], color=colour, linestyle=style) for colour, style in (
        STYLES[True], STYLES[False])] + [target], ["success (counted above)", "failure", target_label], ncol=3)


def add_arguments(parser):
    parser.add_argument("file", metavar="FILE.csv", help="columns seed,frames,success,step,time_s,angle_rad")


def draw(options):
    trials = read_trajectories(options.file)
    with new_figure(PAGE_WIDTH, 1.3 * math.ceil(len(trials) / COLUMNS) + 0.6) as figure:
        draw_all(figure, trials)
        save(figure, options.out)
