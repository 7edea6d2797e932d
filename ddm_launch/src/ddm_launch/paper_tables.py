# Tables of the reproduction: from trials.csv and predictions.csv to what the paper claims.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os
import statistics

from ddm_launch.averages import mean_and_error, success_rates
from ddm_launch.run_folder import number, read_csv, read_sweep

SCHEDULES = ("joint", "sequential", "v_p_only", "joint_random_init")
LATE_FRAMES = (900, 1500)  # the paper's curve is level over these
MOST_ERRORS_BELOW = 2.5  # [standard errors of the paper]
TRIALS_OF_TIMES = (1, 5, 10, 15)


def write_csv(path, header, rows):
    """The file appears only when it is complete."""
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
    with open(path + ".part", "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(header)
        writer.writerows([["%.6g" % cell if isinstance(cell, float) else cell for cell in row] for row in rows])
    os.replace(path + ".part", path)


def success_table(trials, published):
    """Our success rate beside the paper's at equal frames.

    trials: path of a trials.csv of many seeds; published: path of the paper's curves. Rows (frames, seeds, success,
    its standard error, paper's success, its standard error, difference in standard errors of the paper).
    """
    paper = {int(number(row, "frames", published)): row for row in read_csv(published, ["frames", "ddm_mpc"])}
    rows = []
    for frames, rate, error, count in success_rates(read_sweep(trials).values()):
        row = paper.get(frames)
        if row is None:
            continue
        paper_rate, paper_error = number(row, "ddm_mpc", published), number(row, "ddm_mpc_se", published)
        difference = (rate - paper_rate) / paper_error if paper_error > 0.0 else float("nan")
        rows.append((frames, count, rate, error, paper_rate, paper_error, difference))
    return rows


def late_success(trials):
    """{seed: mean success over LATE_FRAMES} of a trials.csv; seeds without such frames are left out."""
    means = {}
    for seed, rows in read_sweep(trials).items():
        late = [float(row.success) for row in rows
                if row.success is not None and LATE_FRAMES[0] <= row.frames <= LATE_FRAMES[1]]
        if late:
            means[seed] = sum(late) / len(late)
    return means


def predictions(path, column, steps=None):
    """{seed: value} of a column of predictions.csv, at so many steps ahead (of the first row if None)."""
    values = {}
    for row in read_csv(path, ["seed", "steps", column]):
        if steps is None or int(number(row, "steps", path)) == steps:
            values.setdefault(int(number(row, "seed", path)), number(row, column, path))
    return values


def error_ratio(path, steps=8):
    """{seed: RMSE so many steps ahead over that of repeating the last frame}."""
    errors, repeats = predictions(path, "rmse", steps), predictions(path, "rmse_repeat", steps)
    return {seed: errors[seed] / repeats[seed] for seed in errors}


def measures(folder, schedule):
    """{measure: {seed: value}} of one schedule in a results folder."""
    trials = os.path.join(folder, "" if schedule == "joint" else schedule, "trials.csv")
    out = {"pendulum_success_900_1500": late_success(trials)}
    for plant, name in (("tile", "tile"), ("pendulum_predictions", "pendulum")):
        path = os.path.join(folder, plant, schedule, "predictions.csv")
        out["%s_rmse_ratio_8" % name] = error_ratio(path)
        out["%s_rmse_ratio_1" % name] = error_ratio(path, 1)
        out["%s_position_r2" % name] = predictions(path, "position_r2")
    return out


def schedule_table(folder):
    """Rows (measure, schedule, seeds, mean, standard error, difference to joint on the same seeds, its standard error)."""
    joint = measures(folder, "joint")
    rows = []
    for schedule in SCHEDULES:
        for measure, values in measures(folder, schedule).items():
            seeds = sorted(set(values) & set(joint[measure]))
            if not seeds:
                continue
            mean, error = mean_and_error([values[seed] for seed in seeds])
            difference, difference_error = mean_and_error([values[seed] - joint[measure][seed] for seed in seeds])
            rows.append((measure, schedule, len(seeds), mean, error, difference, difference_error))
    return sorted(rows, key=lambda row: (row[0], SCHEDULES.index(row[1])))


def time_table(trials):
    """Rows (what, frames, median, largest, unit, source) of a trials.csv, and PILCO's as the paper gives them."""
    rows = []
    table = read_csv(trials, ["trial", "frames", "train_s", "plan_ms_median", "plan_ms_p99"])
    for trial in TRIALS_OF_TIMES:
        of_trial = [row for row in table if int(number(row, "trial", trials)) == trial]
        if not of_trial:
            continue
        seconds = [number(row, "train_s", trials) for row in of_trial]
        rows.append(("training", of_trial[0]["frames"], statistics.median(seconds), max(seconds), "s", "trials.csv"))
    for column, what in (("plan_ms_median", "plan, median of a greedy run"), ("plan_ms_p99", "plan, 99 % of a greedy run")):
        values = [number(row, column, trials) for row in table]
        rows.append((what, "all", statistics.median(values), max(values), "ms", "trials.csv"))
    rows.append(("PILCO on 2-D features, 10 trials", "1000", 10.0, "", "h", "paper, Sec. 4.2 (\"about 10 hours\")"))
    rows.append(("PILCO on 20-D features, 10 trials", "", "", "", "d", "paper, Sec. 4.2 (\"a few days\")"))
    return rows


def tile_rows(folder):
    """Rows (seed, RMSE 8 steps ahead, of repeating, ratio, R^2 of the position) of joint training on the tile."""
    path = os.path.join(folder, "tile", "joint", "predictions.csv")
    errors, repeats = predictions(path, "rmse", 8), predictions(path, "rmse_repeat", 8)
    explained = predictions(path, "position_r2")
    return [(seed, errors[seed], repeats[seed], errors[seed] / repeats[seed], explained[seed])
            for seed in sorted(errors)]


def agreement_table(folder, published):
    """Rows (point, paper or bar, here, holds) for each claim that can be checked by numbers."""
    curve = success_table(os.path.join(folder, "trials.csv"), published)
    below = [row[0] for row in curve if row[6] < -MOST_ERRORS_BELOW]
    late = [row for row in curve if LATE_FRAMES[0] <= row[0] <= LATE_FRAMES[1]]
    rows = [("points of the success curve more than %g of the paper's standard errors below it" % MOST_ERRORS_BELOW,
             "at most 1 of 15", "%d of %d" % (len(below), len(curve)), len(below) <= 1)]
    if late:
        here, paper = (sum(row[k] for row in late) / len(late) for k in (2, 4))
        rows.append(("mean success, %d to %d frames" % LATE_FRAMES, "%.3f" % paper, "%.3f" % here, here >= 0.80))
        rows.append(("success at %d frames" % LATE_FRAMES[1], "%.2f" % late[-1][4], "%.2f" % late[-1][2],
                     late[-1][2] >= late[-1][4] - MOST_ERRORS_BELOW * late[-1][5]))
    oracle = [trial.success for trials in read_sweep(os.path.join(folder, "oracle", "trials.csv")).values()
              for trial in trials if trial.success is not None]
    if oracle:
        rows.append(("oracle: success of the planner with a perfect model", "1.00",
                     "%.4f (%d runs)" % (sum(oracle) / len(oracle), len(oracle)), all(oracle)))
    tile = tile_rows(folder)
    ratio, _ = mean_and_error([row[3] for row in tile])
    explained = statistics.median(row[4] for row in tile)
    rows.append(("tile, joint: 8-step error over that of repeating the last frame, mean of %d seeds" % len(tile),
                 "< 0.5", "%.3f" % ratio, ratio < 0.5))
    rows.append(("tile, joint: held-out position explained by a quadratic map of the features, median R^2",
                 ">= 0.9", "%.3f" % explained, explained >= 0.9))
    by_schedule = {(row[0], row[1]): row for row in schedule_table(folder)}
    for measure, sign, words in (("pendulum_success_900_1500", 1, "pendulum, mean success, 900 to 1500 frames"),
                                 ("pendulum_rmse_ratio_8", -1, "pendulum, 8-step error ratio"),
                                 ("tile_rmse_ratio_8", -1, "tile, 8-step error ratio"),
                                 ("tile_position_r2", 1, "tile, position explained by the features")):
        for schedule in SCHEDULES[1:]:
            row = by_schedule.get((measure, schedule))
            if row is None:
                continue
            joint = by_schedule[measure, "joint"]
            rows.append(("%s: joint better than %s" % (words, schedule), "yes",
                         "joint %.3f, %s %.3f, difference %.3f +- %.3f" % (joint[3], schedule, row[3],
                                                                           -row[5], row[6]),
                         -sign * row[5] > 2.0 * row[6]))
    return [(point, paper, here, "yes" if holds else "no") for point, paper, here, holds in rows]


def write_tables(folder, published):
    """Writes all tables of a results folder; returns the rows of agreement.csv."""
    trials = os.path.join(folder, "trials.csv")
    write_csv(os.path.join(folder, "success_rate.csv"),
              ["frames", "seeds", "success", "success_se", "paper", "paper_se", "difference_in_paper_se"],
              success_table(trials, published))
    write_csv(os.path.join(folder, "schedules.csv"),
              ["measure", "schedule", "seeds", "mean", "se", "difference_to_joint", "difference_se"],
              schedule_table(folder))
    write_csv(os.path.join(folder, "times.csv"), ["what", "frames", "median", "largest", "unit", "source"],
              time_table(trials))
    write_csv(os.path.join(folder, "tile.csv"), ["seed", "rmse_8", "rmse_repeat_8", "ratio", "position_r2"],
              tile_rows(folder))
    agreement = agreement_table(folder, published)
    write_csv(os.path.join(folder, "agreement.csv"), ["point", "paper", "here", "holds"], agreement)
    return agreement
