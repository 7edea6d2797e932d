# What the results of reproduce_efficient must reach, and whether they do.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os

from ddm_launch.tables import optional, read_csv, write_csv
from ddm_study.efficient_tables import REMEDY
from ddm_study.paper_tables import verdict

ROUNDING = 1e-9  # rates are quotients of small whole numbers, and bars decimal fractions
SEEDS, FEW_SEEDS = 50, 20  # with fewer there is no verdict
FIRST_FRAMES, LATER_FRAMES, GRAVITY_FRAMES, NUISANCE_FRAMES = 100, (200, 1600), (1500, 2000), 500
TRIAL_FRAMES = 100
LEAST_FIRST, LEAST_MEAN, LEAST_LATER, MOST_UNSETTLED = 0.86, 0.99, 0.96, 0.04
LEAST_GRAVITY_MEAN, LEAST_GRAVITY, LEAST_NUISANCE = 0.9, 0.8, 0.9
MOST_EXPERIMENT_S, MOST_PLAN_MS = 120.0, 20.0


class Rate(collections.namedtuple("Rate", "frames runs success low high strict nuisance")):
    """A row of a table with success rates and their intervals."""

    def __str__(self):
        return "%.2f [%.2f, %.2f] of %d" % (self.success, self.low, self.high, self.runs)


def read_rates(folder, name, method=None):
    """The rows of a table, those of a method if it has several; none if there is no such table."""
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        return []
    columns = {"frames": int, "runs": int, "success": float, "low": float, "high": float, "success_strict": float}
    return [Rate(*(row[column] for column in columns), nuisance=row.get("nuisance"))
            for row in read_csv(path, columns, REMEDY) if method is None or row["method"] == method]


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
    rows = read_csv(path, {"seed": str, "wall_s": optional(float), "plan_ms_p99": float}, REMEDY)
    num_timed = sum(row["seed"].isdigit() and row["wall_s"] is not None for row in rows)
    wall_s, plan_ms = rows[-1]["wall_s"], rows[-1]["plan_ms_p99"]
    out = []
    if num_timed:
        out.append(("whole experiment, largest of %d seeds" % num_timed, "< %g s" % MOST_EXPERIMENT_S,
                    "%.1f s" % wall_s, wall_s < MOST_EXPERIMENT_S if num_timed >= SEEDS else None))
    return out + [("plan, 99 % of a greedy run, largest", "< %g ms" % MOST_PLAN_MS, "%.1f ms" % plan_ms,
                   plan_ms < MOST_PLAN_MS if len(rows) - 2 >= SEEDS else None)]


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
