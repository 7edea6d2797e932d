# What the results of reproduce_efficient must reach, and whether they do.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch.efficient_tables import REMEDY
from ddm_launch.paper_tables import verdict, write_csv
from ddm_launch.run_folder import number, read_csv

ROUNDING = 1e-9  # rates are quotients of small whole numbers, and bars decimal fractions
SEEDS, FEW_SEEDS = 50, 20  # without as many there is no verdict
FIRST_FRAMES, LATER_FRAMES, GRAVITY_FRAMES, NUISANCE_FRAMES = 100, (200, 1600), (1500, 2000), 500
TRIAL_FRAMES = 100
LEAST_FIRST, LEAST_MEAN, LEAST_LATER, MOST_UNSETTLED = 0.86, 0.99, 0.96, 0.04
LEAST_GRAVITY_MEAN, LEAST_GRAVITY, LEAST_NUISANCE = 0.9, 0.8, 0.9
MOST_EXPERIMENT_S, MOST_PLAN_MS = 120.0, 20.0


class Rate:
    """A row of a table with success rates and their intervals."""

    def __init__(self, row, path):
        self.nuisance = row.get("nuisance")
        self.frames, self.runs = (int(number(row, key, path)) for key in ("frames", "runs"))
        self.success, self.low, self.high, self.strict = (
            number(row, key, path) for key in ("success", "low", "high", "success_strict"))

    def __str__(self):
        return "%.2f [%.2f, %.2f] of %d" % (self.success, self.low, self.high, self.runs)


def read_rates(folder, name, method=None):
    """The rows of a table, those of a method if it has several; none if there is no such table."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return []
    rows = read_csv(path, ["frames", "runs", "success", "low", "high", "success_strict"], REMEDY)
    return [Rate(row, path) for row in rows if method is None or row["method"] == method]


def at_least(value, bar, known):
    return value >= bar - ROUNDING if known else None


def level_rows(what, rates, frames, least_mean, least, num_runs):
    """Rows about mean and lowest point of a curve over a range of frames; none if it has no point there."""
    part = [rate for rate in rates if frames[0] <= rate.frames <= frames[1]]
    if not part:
        return []
    known = ([rate.frames for rate in part] == list(range(frames[0], frames[1] + 1, TRIAL_FRAMES)) and
             all(rate.runs >= num_runs for rate in part))
    mean, lowest = sum(rate.success for rate in part) / len(part), min(part, key=lambda rate: rate.success)
    where = "%s, %d to %d frames" % ((what,) + frames)
    return [("mean " + where, ">= %.2f" % least_mean, "%.3f" % mean, at_least(mean, least_mean, known)),
            ("lowest " + where, ">= %.2f" % least, "%s at %d frames" % (lowest, lowest.frames),
             at_least(lowest.success, least, known))]


def headline_rows(folder):
    rates = read_rates(folder, "success_rate.csv")
    rows = [("success, %d frames" % FIRST_FRAMES, ">= %.2f" % LEAST_FIRST, str(rate),
             at_least(rate.success, LEAST_FIRST, rate.runs >= SEEDS))
            for rate in rates if rate.frames == FIRST_FRAMES]
    rows += level_rows("success", rates, LATER_FRAMES, LEAST_MEAN, LEAST_LATER, SEEDS)
    if rates:
        worst = max(rates, key=lambda rate: rate.success - rate.strict)
        unsettled = worst.success - worst.strict
        rows.append(("success minus success_strict, largest", "<= %.2f" % MOST_UNSETTLED,
                     "%.2f at %d frames" % (unsettled, worst.frames),
                     at_least(-unsettled, -MOST_UNSETTLED, worst.runs >= SEEDS)))
    return rows


def time_rows(folder):
    path = os.path.join(folder, "times.csv")
    if not os.path.exists(path):
        return []
    rows = read_csv(path, ["seed", "wall_s", "plan_ms_p99"], REMEDY)
    seeds = [row for row in rows if row["seed"].isdigit() and row["wall_s"]]
    largest = rows[-1]
    out = []
    if seeds:
        wall_s = number(largest, "wall_s", path)
        out.append(("whole experiment, largest of %d seeds" % len(seeds), "< %g s" % MOST_EXPERIMENT_S,
                    "%.1f s" % wall_s, wall_s < MOST_EXPERIMENT_S if len(seeds) >= SEEDS else None))
    plan_ms = number(largest, "plan_ms_p99", path)
    out.append(("plan, 99 % of a greedy run, largest", "< %g ms" % MOST_PLAN_MS, "%.1f ms" % plan_ms,
                plan_ms < MOST_PLAN_MS if len(rows) - 2 >= SEEDS else None))
    return out


def nuisance_rows(folder):
    return [("nuisance %s: success, %d frames" % (rate.nuisance, rate.frames), ">= %.2f" % LEAST_NUISANCE, str(rate),
             at_least(rate.success, LEAST_NUISANCE, rate.runs >= FEW_SEEDS and rate.frames == NUISANCE_FRAMES))
            for rate in read_rates(folder, "nuisances.csv") if rate.nuisance != "none"]


def write_bars(folder):
    """Writes bars.csv about the tables that are there. Returns its rows (point, bar, here, yes | no | n/a)."""
    rows = (headline_rows(folder) + time_rows(folder) +
            level_rows("success with gravity", read_rates(folder, "gravity.csv", "ddm"), GRAVITY_FRAMES,
                       LEAST_GRAVITY_MEAN, LEAST_GRAVITY, FEW_SEEDS) + nuisance_rows(folder))
    rows = [(point, bar, here, verdict(holds)) for point, bar, here, holds in rows]
    write_csv(os.path.join(folder, "bars.csv"), ["point", "bar", "here", "holds"], rows)
    return rows
