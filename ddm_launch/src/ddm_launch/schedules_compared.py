# Draws the training schedules side by side: success on the pendulum, prediction errors of pendulum and tile.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import os

from ddm_launch.averages import mean_and_error, success_rates
from ddm_launch.figure_style import (BLUE, GREEN, GREY, PAGE_WIDTH, PURPLE, VERMILLION, new_figure, save,
                                     write)
from ddm_launch.run_folder import RunFolderError, number, read_csv, read_sweep

# Value of training/schedule, its label, colour, marker, line.
SCHEDULES = (("joint", "joint", BLUE, "o", "-"),
             ("sequential", "sequential", VERMILLION, "s", "--"),
             ("v_p_only", "$V_P$ only", GREEN, "^", "-."),
             ("joint_random_init", "joint, random start", PURPLE, "D", ":"))
SHIFTS = (-21, -7, 7, 21)  # [frames], of a schedule's success
REMEDY = "rosrun ddm_launch reproduce_paper writes it"


def read_errors(path):
    """The prediction errors of a predictions.csv, as {seed: {steps: (rmse, rmse_repeat)}}."""
    errors = {}
    for row in read_csv(path, ["seed", "steps", "rmse", "rmse_repeat"], REMEDY):
        seed, steps = int(number(row, "seed", path)), int(number(row, "steps", path))
        if steps in errors.setdefault(seed, {}):
            raise RunFolderError("%s holds %d steps of seed %d twice: give each seed once" % (path, steps, seed))
        errors[seed][steps] = (number(row, "rmse", path), number(row, "rmse_repeat", path))
    return errors


def paired(results, what):
    """Only the seeds that all schedules have: the draws of a seed are the same for each schedule.

    results: {schedule: {seed: anything}}. Raises RunFolderError if there is no such seed.
    """
    common = set.intersection(*(set(by_seed) for by_seed in results.values()))
    if not common:
        raise RunFolderError("no seed has %s of all schedules (%s): run the same seeds with each" % (
            what, ", ".join(results)))
    return {schedule: {seed: by_seed[seed] for seed in sorted(common)} for schedule, by_seed in results.items()}


def read_success(folder):
    """{schedule: {seed: list of Trial}} of the results folder."""
    paths = {name: os.path.join(folder, "" if name == "joint" else name, "trials.csv") for name, *_ in SCHEDULES}
    return paired({name: read_sweep(path, REMEDY) for name, path in paths.items()}, "trials")


def read_predictions(folder):
    """{schedule: {seed: {steps: (rmse, rmse_repeat)}}} of one plant's folder."""
    return paired({name: read_errors(os.path.join(folder, name, "predictions.csv")) for name, *_ in SCHEDULES},
                  "predictions")


def seeds_text(results):
    count = len(results["joint"])
    return "%d seed%s" % (count, "" if count == 1 else "s")


def draw_success(axes, results):
    """Success rate over frames, one line per schedule, shifted so that no error bar covers another."""
    for shift, (name, label, colour, marker, line) in zip(SHIFTS, SCHEDULES):
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
    def curve(by_seed, which):
        steps = sorted(set.intersection(*(set(errors) for errors in by_seed.values())))
        return steps, list(zip(*(mean_and_error([errors[k][which] for errors in by_seed.values()]) for k in steps)))

    steps, (means, _) = curve(results["joint"], 1)
    axes.plot(steps, means, color=GREY, linewidth=1.0, linestyle=(0, (1, 1)), marker="x", markersize=3,
              label="repeat the last frame", zorder=1)
    for name, label, colour, marker, line in SCHEDULES:
        steps, (means, errors) = curve(results[name], 0)
        axes.errorbar(steps, means, yerr=errors, color=colour, marker=marker, linestyle=line, capsize=1.5,
                      elinewidth=0.7, markersize=3, label=label)
    axes.set_xticks(steps)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("steps ahead [-]")
    axes.set_ylabel("RMSE over pixels [grey]")


def draw(folder, out):
    """Draws a results folder into a picture file."""
    success = read_success(folder)
    pendulum = read_predictions(os.path.join(folder, "pendulum_predictions"))
    tile = read_predictions(os.path.join(folder, "tile"))
    with new_figure(PAGE_WIDTH, 2.5) as figure:
        grid = figure.add_gridspec(2, 3, height_ratios=[1.0, 0.001])
        panels = [figure.add_subplot(grid[0, column]) for column in range(3)]
        draw_success(panels[0], success)
        draw_predictions(panels[1], pendulum)
        draw_predictions(panels[2], tile)
        for axes, plant, results in zip(panels, ("pendulum, control", "pendulum, prediction", "tile, prediction"),
                                        (success, pendulum, tile)):
            axes.set_title("%s (%s)" % (plant, seeds_text(results)))
            axes.grid(True)
        legend = figure.add_subplot(grid[1, :])
        legend.axis("off")
        handles, labels = panels[1].get_legend_handles_labels()
        legend.legend(handles[1:] + handles[:1], labels[1:] + labels[:1], loc="center", ncol=5, frameon=False,
                      handlelength=2.6)
        save(figure, out)


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="schedules_compared",
        description="Draws success by frames (RESULTS_DIR/trials.csv, RESULTS_DIR/SCHEDULE/trials.csv) and prediction "
        "errors by steps (RESULTS_DIR/{pendulum_predictions,tile}/SCHEDULE/predictions.csv) of the training schedules "
        "%s: means and standard errors over the seeds that all four have. Success is drawn "
        "up to %d frames to the left or right of its place, so that no error bar covers another."
        % (", ".join(row[0] for row in SCHEDULES), SHIFTS[-1]))
    parser.add_argument("folder", metavar="RESULTS_DIR", help="results of reproduce_paper")
    parser.add_argument("--out", metavar="FILE.png", required=True, help="picture to write")
    options = parser.parse_args(arguments)
    return write("schedules_compared", options.out, lambda out: draw(options.folder, out))
