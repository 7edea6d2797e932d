# Draws the training schedules side by side: success on the pendulum, prediction errors of pendulum and tile.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.averages import mean_and_error, success_rates
from ddm_launch.figure_style import BLUE, GREEN, GREY, PAGE_WIDTH, PURPLE, VERMILLION, add_legend, new_figure, save
from ddm_study.schedules import SCHEDULES, read_predictions, read_success

ABOUT = ("Success by frames and prediction errors by steps of the training schedules. From a folder of reproduce_paper: "
         "means and standard errors over the seeds that all four have. Success is drawn a few frames to the left or right, "
         "so that no error bar covers another.")
# Label, colour, marker, line.
STYLES = (("joint", BLUE, "o", "-"),
          ("sequential", VERMILLION, "s", "--"),
          ("$V_P$ only", GREEN, "^", "-."),
          ("joint, random start", PURPLE, "D", ":"))  # in the order of SCHEDULES
SHIFTS = (-21, -7, 7, 21)  # [frames], of a schedule's success


def seeds_text(results):
    count = len(results["joint"])
    return "%d seed%s" % (count, "" if count == 1 else "s")


def draw_success(axes, results):
    """Success rate over frames, one line per schedule, shifted so that no error bar covers another."""
    for shift, name, (label, colour, marker, line) in zip(SHIFTS, SCHEDULES, STYLES):
        rows = success_rates(results[name].values())
        axes.errorbar([row[0] + shift for row in rows], [row[1] for row in rows], yerr=[row[2] for row in rows],
                      color=colour, marker=marker, linestyle=line, capsize=1.5, elinewidth=0.7, markersize=3,
                      label=label)
    axes.set_xlim(left=0)
    axes.set_ylim(-0.04, 1.04)
    axes.set_xlabel("frames learned from\n[image-torque pairs]")
    axes.set_ylabel("success rate [-]")


def draw_predictions(axes, results):
    """Prediction error over steps ahead, one line per schedule, and that of repeating the last frame."""
    def curve(by_seed, value):
        steps = sorted(set.intersection(*(set(errors) for errors in by_seed.values())))
        return steps, list(zip(*(mean_and_error([value(errors[k]) for errors in by_seed.values()]) for k in steps)))

    steps, (means, _) = curve(results["joint"], lambda prediction: prediction.rmse_repeat)
    axes.plot(steps, means, color=GREY, linewidth=1.0, linestyle=(0, (1, 1)), marker="x", markersize=3,
              label="repeat the last frame", zorder=1)
    for name, (label, colour, marker, line) in zip(SCHEDULES, STYLES):
        steps, (means, errors) = curve(results[name], lambda prediction: prediction.rmse)
        axes.errorbar(steps, means, yerr=errors, color=colour, marker=marker, linestyle=line, capsize=1.5,
                      elinewidth=0.7, markersize=3, label=label)
    axes.set_xticks(steps)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("steps ahead [-]")
    axes.set_ylabel("RMSE over pixels [grey]")


def add_arguments(parser):
    parser.add_argument("folder", metavar="RESULTS_DIR", help="results of reproduce_paper")


def draw(options):
    results = [("pendulum, control", read_success(options.folder))] + [
        ("%s, prediction" % plant, read_predictions(os.path.join(options.folder, plant + "_predictions")))
        for plant in ("pendulum", "tile")]
    with new_figure(PAGE_WIDTH, 2.5) as figure:
        grid = figure.add_gridspec(2, 3, height_ratios=[1.0, 0.001])
        for column, (title, by_schedule) in enumerate(results):
            axes = figure.add_subplot(grid[0, column])
            (draw_predictions if column else draw_success)(axes, by_schedule)
            axes.set_title("%s (%s)" % (title, seeds_text(by_schedule)))
            axes.grid(True)
        handles, labels = axes.get_legend_handles_labels()
        add_legend(figure, grid[1, :], handles[1:] + handles[:1], labels[1:] + labels[:1], ncol=5, handlelength=2.6)
        save(figure, options.out)
