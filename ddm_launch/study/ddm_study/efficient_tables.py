# Tables of reproduce_efficient: success with intervals, what each ingredient is worth, times, and what these must reach.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import os
import statistics

from ddm_launch.averages import holm, mean_and_error, sign_test, success_rates, wilson_interval
from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep
from ddm_launch.settings import read_yaml
from ddm_launch.tables import optional, read_csv, write_csv
from ddm_study.paper_tables import verdict

REMEDY = "rosrun ddm_launch reproduce_efficient writes it"
INTERVALS = ["success", "low", "high", "success_strict", "strict_low", "strict_high"]
PRESET = "preset"  # folder of the ablation's reference
GRAVITY = (("ddm", "gravity/trials.csv"), ("pilco_state", "gravity/pilco_state/trials.csv"),
           ("oracle", "gravity/oracle/trials.csv"))  # method, table

# What the results must reach. Runs of fewer seeds get no verdict.
SEEDS, FEW_SEEDS, FEWEST_SEEDS = 50, 20, 10

# A task of the DeepMind Control Suite: its name there, a physics frame [s], and the last models of how many seeds must have which
# mean return.
SuiteTask = collections.namedtuple("SuiteTask", "name step_s least_return least_seeds")
PENDULUM_SWINGUP = SuiteTask("pendulum_swingup", 0.02, 700.0, 16)
# What is learned beyond the pendulum. num_trials: after the first; of 100 images, with a suite of 400. nuisance: of the scene, or
# none. suite: SuiteTask, or None.
Task = collections.namedtuple("Task", "plant nuisance num_trials num_seeds suite")
TASKS = {"two_link": Task("two_link", "", 19, FEW_SEEDS, None),
         "suite_pendulum": Task("suite_pendulum", "", 9, FEW_SEEDS, PENDULUM_SWINGUP),
         "suite_reacher": Task("suite_reacher", "", 9, FEW_SEEDS, SuiteTask("reacher_easy", 0.02, 800.0, 16)),
         "suite_reacher_hard": Task("suite_reacher_hard", "", 9, FEW_SEEDS, SuiteTask("reacher_hard", 0.02, 800.0, 16)),
         "suite_cartpole": Task("suite_cartpole", "", 18, FEW_SEEDS, SuiteTask("cartpole_swingup", 0.01, 700.0, 10)),
         "suite_acrobot": Task("suite_acrobot", "", 18, FEW_SEEDS, SuiteTask("acrobot_swingup", 0.01, 300.0, 10))}
for nuisance in ("scene_camera", "scene_colours"):
    TASKS["suite_pendulum_" + nuisance] = Task("suite_pendulum", nuisance, 9, FEWEST_SEEDS,
                                               PENDULUM_SWINGUP._replace(least_seeds=5))
SUITE = {name: task.suite for name, task in TASKS.items() if task.suite}

FIRST_FRAMES, LATER_FRAMES, GRAVITY_FRAMES, NUISANCE_FRAMES = 100, (200, 1600), (1500, 2000), (200, 500)
TRIAL_FRAMES = 100
LEAST_FIRST, LEAST_MEAN, LEAST_LATER, MOST_UNSETTLED = 0.86, 0.99, 0.96, 0.04
LEAST_GRAVITY_MEAN, LEAST_GRAVITY = 0.97, 0.8
LEAST_NUISANCE_FIRST, LEAST_NUISANCE_LATER = 0.85, 0.97
TWO_LINK_FRAMES, LEAST_TWO_LINK_MEAN, LEAST_TWO_LINK = (1000, 2000), 0.85, 0.7
MOST_EXPERIMENT_S, MOST_PLAN_MS = 120.0, 20.0
ROUNDING = 1e-9  # rates are quotients of small whole numbers, and targets decimal fractions


def interval_cells(row):
    """Rate and 95 % interval of a row of success_rates(), or empty cells."""
    return (row[1],) + wilson_interval(row[1], row[3]) if row else ("", "", "")


def success_rows(runs):
    """Rows (frames, runs, success, its 95 % interval, success_strict, its interval) of {seed: list of Trial}."""
    strict = {row[0]: row for row in success_rates(runs.values(), "success_strict")}
    return [(row[0], row[3]) + interval_cells(row) + interval_cells(strict.get(row[0]))
            for row in success_rates(runs.values())]


def read_runs(folder, *names):
    return read_sweep(os.path.join(folder, *names), REMEDY)


def time_rows(trials, sweep_folder, resumed=()):
    """Rows (seed, training in all [s], wall time of the experiment [s], slowest run's 99 % of plans [ms]).

    Two last rows hold median and largest. The wall time is in the seed's folder of the sweep. It is not known (empty) of
    the seeds that were resumed: theirs is that of the last call alone.
    """
    seeds = {}
    for row in read_csv(trials, {"seed": int, "train_s": float, "plan_ms_p99": float}, REMEDY):
        seeds.setdefault(row["seed"], []).append((row["train_s"], row["plan_ms_p99"]))
    rows = []
    for seed, times in seeds.items():
        summary = {} if seed in resumed else read_yaml(os.path.join(sweep_folder, "seed_%04d" % seed, "summary.yaml"))
        train_s, plan_ms = zip(*times)
        rows.append((seed, sum(train_s), summary.get("wall_s", ""), max(plan_ms)))
    columns = [[value for value in column if value != ""] for column in zip(*(row[1:] for row in rows))]
    return rows + [(name,) + tuple(of(column) if column else "" for column in columns)
                   for name, of in (("median", statistics.median), ("largest", max))]


def mean_success(runs, frames):
    """{seed: mean success over these frames} of the seeds that know it at all of them."""
    means = {}
    for seed, trials in runs.items():
        values = {trial.frames: trial.success for trial in trials if trial.success is not None}
        if values.keys() >= set(frames):
            means[seed] = sum(values[count] for count in frames) / len(frames)
    return means


def variant_rows(folder, part, labels):
    """Rows (variant, label, frames, seeds, success, its standard error, difference to the preset, its standard error,
    p of the sign test, p by Holm over all variants at these frames).

    labels: {variant: label}; the results of each lie in FOLDER/PART/VARIANT, those of the preset itself, PRESET, in
    FOLDER/ablation. Differences are paired by seed; the preset has neither p. Single frames come first, those that each
    variant has; then the mean over all, and over all but the first.
    """
    variants = {name: read_runs(folder, "ablation" if name == PRESET else part, name, "trials.csv") for name in labels}
    frames = sorted(set.intersection(*({row[0] for row in success_rates(runs.values())}
                                       for runs in variants.values())))
    if not frames:
        raise Failure("%s: no number of frames is known of %s and the preset itself: run each with as many frames a "
                      "trial" % (os.path.join(folder, part), ", ".join(name for name in labels if name != PRESET)))
    groups = {str(count): [count] for count in frames}
    groups.update(("%d to %d" % (some[0], some[-1]), some) for some in (frames, frames[1:]) if len(some) > 1)
    measured, p_values = {}, {}
    for text, group in groups.items():
        reference, differences = mean_success(variants[PRESET], group), {}
        for variant in labels:
            values = mean_success(variants[variant], group)
            seeds = sorted(set(values) & set(reference))
            if not seeds:
                raise Failure("no seed has %s frames of both %s and the preset itself: run the same seeds with each"
                              % (text, variant))
            differences[variant] = [values[seed] - reference[seed] for seed in seeds]
            measured[variant, text] = ((len(seeds),) + mean_and_error([values[seed] for seed in seeds]) +
                                       mean_and_error(differences[variant]))
        p = {variant: sign_test(differences[variant]) for variant in labels if variant != PRESET}
        p_values.update(((variant, text), both) for variant, both in zip(p, zip(p.values(), holm(list(p.values())))))
    return [(variant, labels[variant], text) + measured[variant, text] + p_values.get((variant, text), ("", ""))
            for variant in labels for text in groups]


def nuisance_rows(folder, names):
    """Rows (nuisance, frames, runs, success, interval, success_strict, interval).

    The first rows are the same seeds without any, where the headline has them. Raises Failure if a nuisance has no known
    success, or other frames than the first one.
    """
    rows, seeds, frames = [], set(), None
    for name in names:
        path = os.path.join(folder, "nuisances", name, "trials.csv")
        runs = read_sweep(path, REMEDY)
        known = success_rows(runs)
        if not known:
            raise Failure("%s must say of some trial whether it was a success, column success is empty: use a plant "
                          "with a goal" % path)
        here = [row[0] for row in known]
        frames = frames or here
        if here != frames:
            raise Failure("%s must end at %d frames as that of %s, got %d: make it again with as many trials"
                          % (path, frames[-1], names[0], here[-1]))
        rows += [(name,) + row for row in known]
        seeds |= set(runs)
    if os.path.exists(os.path.join(folder, "trials.csv")):
        runs = {seed: trials for seed, trials in read_runs(folder, "trials.csv").items() if seed in seeds}
        rows[:0] = [("none",) + row for row in success_rows(runs) if row[0] in frames]
    return rows


def gravity_rows(folder):
    """Rows (method, frames, runs, success, interval, success_strict, interval) of the methods that were run."""
    return [(method,) + row for method, table in GRAVITY if os.path.exists(os.path.join(folder, table))
            for row in success_rows(read_runs(folder, table))]


def task_rows(folder, names):
    """Rows (task, frames, physics frames, robot time [s], runs, success, its interval, mean return, its standard error).
    Plants that are not of the suite have neither physics frames nor returns."""
    rows = []
    for name in names:
        path = os.path.join(folder, "tasks", name)
        returns = {}
        for row in read_csv(os.path.join(path, "trials.csv"), {"frames": int, "return": optional(float)}, REMEDY):
            if row["return"] is not None:
                returns.setdefault(row["frames"], []).append(row["return"])
        dt = float(read_yaml(os.path.join(path, "config.yaml"))["plant"]["dt"])
        for frames, rate, _, runs in success_rates(read_sweep(os.path.join(path, "trials.csv"), REMEDY).values()):
            time_s = round(frames * dt, 6)
            physics_frames = round(time_s / SUITE[name].step_s) if name in SUITE else ""
            rows.append((name, frames, physics_frames, time_s, runs, rate) + wilson_interval(rate, runs) +
                        (mean_and_error(returns[frames]) if frames in returns else ("", "")))
    return rows


def write_tasks(folder, names):
    write_csv(os.path.join(folder, "tasks.csv"),
              ["task", "frames", "physics_frames", "robot_s", "runs", "success", "low", "high", "mean_return",
               "return_se"], task_rows(folder, names))


def write_last_models(folder, name, evaluations):
    """tasks/NAME/last_models.csv: what each seed's last model does from several starts.

    evaluations: {seed: folder of evaluate}
    """
    rows = []
    for seed, path in evaluations.items():
        episodes = read_csv(os.path.join(path, "evaluation.csv"), {"success": int, "return": float}, REMEDY)
        rows.append((seed, len(episodes), statistics.mean(episode["success"] for episode in episodes),
                     statistics.mean(episode["return"] for episode in episodes)))
    write_csv(os.path.join(folder, "tasks", name, "last_models.csv"), ["seed", "episodes", "success", "mean_return"], rows)


def write_success(folder, sweep_folder, resumed=()):
    trials = os.path.join(folder, "trials.csv")
    write_csv(os.path.join(folder, "success_rate.csv"), ["frames", "runs"] + INTERVALS,
              success_rows(read_sweep(trials, REMEDY)))
    write_csv(os.path.join(folder, "times.csv"), ["seed", "train_s", "wall_s", "plan_ms_p99"],
              time_rows(trials, sweep_folder, resumed))


def write_variants(folder, part, labels):
    write_csv(os.path.join(folder, part + ".csv"),
              ["variant", "label", "frames", "seeds", "success", "success_se", "difference", "difference_se", "p",
               "p_holm"],
              variant_rows(folder, part, labels))


def write_gravity(folder):
    write_csv(os.path.join(folder, "gravity.csv"), ["method", "frames", "runs"] + INTERVALS, gravity_rows(folder))


def write_nuisances(folder, names):
    write_csv(os.path.join(folder, "nuisances.csv"), ["nuisance", "frames", "runs"] + INTERVALS,
              nuisance_rows(folder, names))


class Rate(collections.namedtuple("Rate", "frames runs success low high strict name")):
    """A row of a table with success rates and their intervals; name: of its method or nuisance."""

    def __str__(self):
        return "%.2f [%.2f, %.2f] of %d" % (self.success, self.low, self.high, self.runs)


def read_rates(folder, name):
    """The rows of a table; none if there is no such table."""
    path = os.path.join(folder, name)
    columns = {"frames": int, "runs": int, "success": float, "low": float, "high": float}
    return [Rate(*(row[column] for column in columns), strict=float(row.get("success_strict") or "nan"),
                 name=row.get("method") or row.get("nuisance") or row.get("task"))
            for row in read_csv(path, columns, REMEDY)] if os.path.exists(path) else []


def at_least(point, least, value, here, known):
    return point, ">= %.2f" % least, here, value >= least - ROUNDING if known else None


def level_targets(what, rates, frames, least_mean, least, num_runs):
    """Targets for mean and lowest point of a curve over a range of frames; none if it has no point there."""
    part = [rate for rate in rates if frames[0] <= rate.frames <= frames[1]]
    if not part:
        return []
    known = ([rate.frames for rate in part] == list(range(frames[0], frames[1] + 1, TRIAL_FRAMES)) and
             all(rate.runs >= num_runs for rate in part))
    mean, lowest = sum(rate.success for rate in part) / len(part), min(part, key=lambda rate: rate.success)
    where = "%s, %d to %d frames" % ((what,) + frames)
    return [at_least("mean " + where, least_mean, mean, "%.3f" % mean, known),
            at_least("lowest " + where, least, lowest.success, "%s at %d frames" % (lowest, lowest.frames), known)]


def headline_targets(folder):
    rates = read_rates(folder, "success_rate.csv")
    rows = [at_least("success, %d frames" % FIRST_FRAMES, LEAST_FIRST, rate.success, str(rate), rate.runs >= SEEDS)
            for rate in rates if rate.frames == FIRST_FRAMES]
    rows += level_targets("success", rates, LATER_FRAMES, LEAST_MEAN, LEAST_LATER, SEEDS)
    if rates:
        worst = max(rates, key=lambda rate: rate.success - rate.strict)
        unsettled = worst.success - worst.strict
        rows.append(("success minus success_strict, largest", "<= %.2f" % MOST_UNSETTLED,
                     "%.2f at %d frames" % (unsettled, worst.frames),
                     unsettled <= MOST_UNSETTLED + ROUNDING if worst.runs >= SEEDS else None))
    return rows


def time_targets(folder):
    path = os.path.join(folder, "times.csv")
    if not os.path.exists(path):
        return []
    rows = read_csv(path, {"seed": str, "wall_s": optional(float), "plan_ms_p99": float}, REMEDY)
    num_timed = sum(row["seed"].isdigit() and row["wall_s"] is not None for row in rows)
    largest, targets = rows[-1], []
    if num_timed:
        targets.append(("whole experiment, largest of %d seeds" % num_timed, "< %g s" % MOST_EXPERIMENT_S,
                     "%.1f s" % largest["wall_s"],
                     largest["wall_s"] < MOST_EXPERIMENT_S if num_timed >= SEEDS else None))
    return targets + [("plan, 99 % of a greedy run, largest", "< %g ms" % MOST_PLAN_MS, "%.1f ms" % largest["plan_ms_p99"],
                    largest["plan_ms_p99"] < MOST_PLAN_MS if len(rows) - 2 >= SEEDS else None)]


def nuisance_targets(rates):
    """Targets for the mean of all nuisances, after the first trial and after those that follow."""
    targets = []
    for frames, least in (((FIRST_FRAMES, FIRST_FRAMES), LEAST_NUISANCE_FIRST), (NUISANCE_FRAMES, LEAST_NUISANCE_LATER)):
        part = [rate for rate in rates if frames[0] <= rate.frames <= frames[1]]
        if part:
            mean = sum(rate.success for rate in part) / len(part)
            points = {rate.frames for rate in part}
            known = (points == set(range(frames[0], frames[1] + 1, TRIAL_FRAMES)) and
                     all(rate.runs >= FEW_SEEDS for rate in part))
            targets.append(at_least("mean success of the nuisances, %s frames" % " to ".join(
                map(str, sorted(set(frames)))), least, mean, "%.3f" % mean, known))
    return targets


def task_targets(folder):
    """Targets for two links, and for the last models of tasks of the suite."""
    targets = level_targets("success of two_link", [rate for rate in read_rates(folder, "tasks.csv") if rate.name == "two_link"],
                      TWO_LINK_FRAMES, LEAST_TWO_LINK_MEAN, LEAST_TWO_LINK, FEW_SEEDS)
    for name, task in SUITE.items():
        path = os.path.join(folder, "tasks", name, "last_models.csv")
        if os.path.exists(path):
            returns = [row["mean_return"] for row in read_csv(path, {"mean_return": float}, REMEDY)]
            reached = sum(value >= task.least_return for value in returns)
            targets.append(("seeds of %s with a mean return of %g" % (name, task.least_return),
                         ">= %d of %d" % (task.least_seeds, TASKS[name].num_seeds), "%d of %d" % (reached, len(returns)),
                         reached >= task.least_seeds if len(returns) >= TASKS[name].num_seeds else None))
    return targets


def write_targets(folder):
    """Writes targets.csv about the tables that are there. Returns its rows (point, target, here, yes | no | n/a)."""
    gravity = [rate for rate in read_rates(folder, "gravity.csv") if rate.name == "ddm"]
    targets = headline_targets(folder) + time_targets(folder) + level_targets(
        "success with gravity", gravity, GRAVITY_FRAMES, LEAST_GRAVITY_MEAN, LEAST_GRAVITY, FEW_SEEDS)
    targets += nuisance_targets([rate for rate in read_rates(folder, "nuisances.csv") if rate.name != "none"])
    targets += task_targets(folder)
    rows = [(point, target, here, verdict(holds)) for point, target, here, holds in targets]
    write_csv(os.path.join(folder, "targets.csv"), ["point", "target", "here", "holds"], rows)
    return rows
