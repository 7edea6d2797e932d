# Tables of the reproduction: from trials.csv and predictions.csv to what the paper claims.
# SPDX-License-Identifier: BSD-3-Clause
import os
import statistics

from ddm_launch.averages import mean_and_error, success_rates
from ddm_launch.run_folder import read_sweep
from ddm_launch.tables import read_csv, write_csv
from ddm_study import pilco_tables
from ddm_study.schedules import SCHEDULES, read_predictions, read_predictions_csv, read_success

LATE_FRAMES = (900, 1500)  # the paper's curve is level over these
NUM_POINTS = 15  # of the paper's curve that count: 100 to 1500 frames
MOST_ERRORS_BELOW = 2.5  # [standard errors of the paper]
LEAST_LATE_SUCCESS = 0.80
MOST_ERROR_RATIO = 0.5
LEAST_EXPLAINED = 0.9
TRIALS_OF_TIMES = (0, 4, 9, 14)  # 100 to 1500 frames


def success_table(trials, published):
    """Our success rate next to the paper's at equal frames.

    trials: path of a trials.csv of many seeds; published: path of the paper's curves. Rows (frames, seeds, success,
    its standard error, paper's success, its standard error, difference in standard errors of the paper).
    """
    paper = {row["frames"]: (row["ddm_mpc"], row["ddm_mpc_se"])
             for row in read_csv(published, {"frames": int, "ddm_mpc": float, "ddm_mpc_se": float})}
    rows = []
    for frames, rate, error, count in success_rates(read_sweep(trials).values()):
        if frames in paper:
            paper_rate, paper_error = paper[frames]
            difference = (rate - paper_rate) / paper_error if paper_error > 0.0 else float("nan")
            rows.append((frames, count, rate, error, paper_rate, paper_error, difference))
    return rows


def late_success(runs):
    """{seed: mean success over LATE_FRAMES} of {seed: list of Trial}; seeds without such frames are left out."""
    late = {seed: [trial.success for trial in trials
                   if trial.success is not None and LATE_FRAMES[0] <= trial.frames <= LATE_FRAMES[1]]
            for seed, trials in runs.items()}
    return {seed: sum(values) / len(values) for seed, values in late.items() if values}


def schedule_table(folder):
    """Rows (measure, schedule, seeds, mean, standard error, mean difference to joint, its standard error).

    Only of the seeds that all schedules have; differences are paired by seed.
    """
    measures = {"pendulum_success_900_1500": {name: late_success(runs) for name, runs in read_success(folder).items()}}
    for plant in ("tile", "pendulum"):
        of_plant = read_predictions(os.path.join(folder, plant + "_predictions"))
        for measure, value in (("error_ratio_1", lambda steps: steps[1].ratio),
                               ("error_ratio_8", lambda steps: steps[8].ratio),
                               ("position_r2", lambda steps: steps[1].position_r2)):
            measures["%s_%s" % (plant, measure)] = {
                name: {seed: value(steps) for seed, steps in by_seed.items()} for name, by_seed in of_plant.items()}
    rows = []
    for measure, by_schedule in measures.items():
        for schedule in SCHEDULES:
            values, joint = by_schedule[schedule], by_schedule["joint"]
            if values:
                rows.append((measure, schedule, len(values)) + mean_and_error(list(values.values())) +
                            mean_and_error([values[seed] - joint[seed] for seed in values]))
    return rows


def time_table(trials):
    """Rows (what, frames, median, largest, unit, source) of DDM + MPC's trials.csv, and PILCO's as the paper says."""
    rows = []
    table = read_csv(trials, {"trial": int, "frames": str, "train_s": float, "plan_ms_median": float,
                              "plan_ms_p99": float})

    def add(what, frames, values, unit):
        if values:
            rows.append((what, frames, statistics.median(values), max(values), unit, "trials.csv"))

    for trial in TRIALS_OF_TIMES:
        of_trial = [row for row in table if row["trial"] == trial]
        add("training", of_trial and of_trial[0]["frames"], [row["train_s"] for row in of_trial], "s")
    add("plan, median of a greedy run", "all", [row["plan_ms_median"] for row in table], "ms")
    add("plan, 99 % of a greedy run", "all", [row["plan_ms_p99"] for row in table], "ms")
    rows.append(("PILCO on 2-D features, 10 trials", "1000", 10.0, "", "h", "paper, Sec. 4.2 (\"about 10 hours\")"))
    rows.append(("PILCO on 20-D features, 10 trials", "", "", "", "d", "paper, Sec. 4.2 (\"a few days\")"))
    return rows


def solver_table(folder):
    """Rows (solver, frames, seeds, successes, medians of V_R and V_P per frame [grey^2] and of the time to train [s]) of
    L-BFGS, which the preset has, and of BFGS, which the paper names, on the seeds and frames that both have."""
    columns = {"seed": int, "frames": int, "success": int, "v_r": float, "v_p": float, "train_s": float}
    runs = {solver: {(row["seed"], row["frames"]): row for row in read_csv(os.path.join(folder, name), columns)}
            for solver, name in (("lbfgs", "trials.csv"), ("bfgs", "bfgs/trials.csv"))}
    common = sorted(set(runs["lbfgs"]) & set(runs["bfgs"]))
    rows = []
    for solver, by_model in runs.items():
        for frames in sorted({frames for _, frames in common}):
            models = [by_model[key] for key in common if key[1] == frames]
            rows.append((solver, frames, len(models), sum(model["success"] for model in models)) + tuple(
                statistics.median(model[name] / divisor for model in models)
                for name, divisor in (("v_r", frames), ("v_p", frames), ("train_s", 1.0))))
    return rows


def tile_rows(folder):
    """Rows (seed, RMSE 8 steps ahead, of repeating, ratio, R^2 of the position) of joint training on the tile."""
    predictions = read_predictions_csv(os.path.join(folder, "tile", "predictions.csv"))
    return [(seed, steps[8].rmse, steps[8].rmse_repeat, steps[8].ratio, steps[8].position_r2)
            for seed, steps in sorted(predictions.items())]


def verdict(holds):
    return {True: "yes", False: "no", None: "n/a"}[holds]


def curve_rows(folder, published):
    """Rows of the agreement about the success curve and the oracle."""
    curve = [row for row in success_table(os.path.join(folder, "trials.csv"), published) if row[0] <= LATE_FRAMES[1]]
    complete = len(curve) == NUM_POINTS
    below = sum(row[6] < -MOST_ERRORS_BELOW for row in curve)
    rows = [("success: points of the curve more than %g of the paper's standard errors below it" % MOST_ERRORS_BELOW,
             "<= 1 of %d" % NUM_POINTS, "%d of %d" % (below, len(curve)), below <= 1 if complete else None)]
    if complete:
        late = [row for row in curve if row[0] >= LATE_FRAMES[0]]
        here, paper = (sum(row[k] for row in late) / len(late) for k in (2, 4))
        rows.append(("success: mean over %d to %d frames" % LATE_FRAMES,
                     ">= %.2f (paper: %.3f)" % (LEAST_LATE_SUCCESS, paper), "%.3f" % here, here >= LEAST_LATE_SUCCESS))
        rows.append(("success after %d frames" % LATE_FRAMES[1], "paper: %.2f +- %.2f" % curve[-1][4:6],
                     "%.2f +- %.2f" % curve[-1][2:4], abs(curve[-1][6]) <= MOST_ERRORS_BELOW))
    oracle = [trial.success for trials in read_sweep(os.path.join(folder, "oracle", "trials.csv")).values()
              for trial in trials if trial.success is not None]
    rows.append(("oracle: success of the same planner with a perfect model", "1.00",
                 "%.4f of %d runs" % (sum(oracle) / max(1, len(oracle)), len(oracle)),
                 all(oracle) if oracle else None))
    return rows


def tile_agreement(folder):
    tile = tile_rows(folder)
    ratio, error = mean_and_error([row[3] for row in tile])
    explained = statistics.median(row[4] for row in tile)
    seeds = "%d seeds" % len(tile)
    return [("tile: error 8 steps ahead over that of repeating the last frame, mean of " + seeds,
             "< %g" % MOST_ERROR_RATIO, "%.3f +- %.3f" % (ratio, error), ratio < MOST_ERROR_RATIO),
            ("tile: R^2 of the position, a quadratic map of the features on held-out frames, median of " + seeds,
             ">= %g" % LEAST_EXPLAINED, "%.3f" % explained, explained >= LEAST_EXPLAINED)]


def schedule_agreement(folder):
    """Joint training against each other schedule; what the paper does not claim has no verdict."""
    table = {(row[0], row[1]): row for row in schedule_table(folder)}
    rows = []
    for measure, sign in (("pendulum_success_900_1500", 1), ("pendulum_error_ratio_8", -1), ("tile_error_ratio_8", -1),
                          ("tile_position_r2", 1)):
        for schedule in SCHEDULES[1:]:
            row = table.get((measure, schedule))
            if row is None:
                continue
            claimed = schedule == "sequential" or (schedule == "v_p_only" and measure != "tile_position_r2")
            gain, error = -sign * row[5], row[6]  # by how much joint is better
            holds = gain > 2.0 * error if claimed and error > 0.0 else None
            rows.append(("%s: joint against %s" % (measure, schedule), "better" if claimed else "not claimed",
                         "%.3f against %.3f, better by %.3f +- %.3f" % (
                             table[measure, "joint"][3], row[3], gain, error), holds))
    return rows


def agreement_table(folder, published, pilco=()):
    """Rows (point, claim of the paper or target, here, yes | no | n/a) of all that numbers can decide.

    pilco: those of pilco_tables.LABELS that have results.
    """
    rows = (curve_rows(folder, published) + tile_agreement(folder) + schedule_agreement(folder) +
            pilco_tables.agreement_rows(folder, pilco))
    return [(point, claim, here, verdict(holds)) for point, claim, here, holds in rows]


def write_tables(folder, published, pilco=()):
    """Writes all tables of a results folder; returns the rows of agreement.csv. pilco: see agreement_table()."""
    trials = os.path.join(folder, "trials.csv")
    agreement = agreement_table(folder, published, pilco)
    tables = {
        "success_rate": ("frames seeds success success_se paper paper_se difference_in_paper_se",
                         success_table(trials, published)),
        "schedules": ("measure schedule seeds mean se difference_to_joint difference_se", schedule_table(folder)),
        "solvers": ("solver frames seeds successes v_r_per_frame v_p_per_frame train_s", solver_table(folder)),
        "times": ("what frames median largest unit source", time_table(trials) + pilco_tables.time_rows(folder, pilco)),
        "tile": ("seed rmse_8 rmse_repeat_8 ratio position_r2", tile_rows(folder)),
        "agreement": ("point claim_or_target here holds", agreement)}
    if pilco:
        tables["pilco"] = ("method policies frames successes runs authors_successes authors_runs",
                           pilco_tables.success_rows(folder, pilco))
    for name, (columns, rows) in tables.items():
        write_csv(os.path.join(folder, name + ".csv"), columns.split(), rows)
    return agreement
