# Tables of reproduce_efficient: success with intervals, what each ingredient is worth, times, and what the bars say.
# SPDX-License-Identifier: BSD-3-Clause
import os
import statistics

from ddm_launch.averages import mean_and_error, success_rates, wilson_interval
from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep
from ddm_launch.settings import read_yaml
from ddm_launch.tables import read_csv, write_csv

REMEDY = "rosrun ddm_launch reproduce_efficient writes it"
INTERVALS = ["success", "low", "high", "success_strict", "strict_low", "strict_high"]
PRESET = "preset"  # folder of the ablation's reference
GRAVITY = (("ddm", "gravity/trials.csv"), ("pilco_state", "gravity/pilco_state/trials.csv"),
           ("oracle", "gravity/oracle/trials.csv"))  # method, table


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
        values = {trial.frames: float(trial.success) for trial in trials if trial.success is not None}
        if all(count in values for count in frames):
            means[seed] = sum(values[count] for count in frames) / len(frames)
    return means


def variant_rows(folder, part, labels):
    """Rows (variant, label, frames, seeds, success, its standard error, difference to the preset, its standard error).

    labels: {variant: label}; the results of each lie in FOLDER/PART/VARIANT, those of the preset itself, PRESET, in
    FOLDER/ablation. Differences are paired by seed. Single frames come first, those that each variant has; then the
    mean over all, and over all but the first.
    """
    rows, variants = [], {name: read_runs(folder, "ablation" if name == PRESET else part, name, "trials.csv")
                          for name in labels}
    preset = variants[PRESET]
    frames = sorted(set.intersection(*({row[0] for row in success_rates(runs.values())}
                                       for runs in variants.values())))
    if not frames:
        raise Failure("%s: no number of frames is known of %s and the preset itself: run each with as many "
                             "frames a trial" % (os.path.join(folder, part), ", ".join(
                                 name for name in labels if name != PRESET)))
    groups = [[count] for count in frames] + [some for some in (frames, frames[1:]) if len(some) > 1]
    for variant, label in labels.items():
        runs = variants[variant]
        for group in groups:
            values, reference = mean_success(runs, group), mean_success(preset, group)
            seeds = sorted(set(values) & set(reference))
            if not seeds:
                raise Failure("no seed has %s frames of both %s and the preset itself: run the same seeds with "
                                     "each" % (frames_text(group), variant))
            rows.append((variant, label, frames_text(group), len(seeds)) +
                        mean_and_error([values[seed] for seed in seeds]) +
                        mean_and_error([values[seed] - reference[seed] for seed in seeds]))
    return rows


def frames_text(frames):
    return "%d" % frames[0] if len(frames) == 1 else "%d to %d" % (frames[0], frames[-1])


def nuisance_table(folder, name):
    return os.path.join(folder, "nuisances", name, "trials.csv")


def nuisance_rows(folder, names):
    """Rows (nuisance, frames, runs, success, interval, success_strict, interval) after the last trial.

    The first row is the same seeds without any, where the headline has them. Raises Failure if a nuisance has
    no known success, or other frames than the first one.
    """
    rows, seeds = [], set()
    for name in names:
        runs = read_sweep(nuisance_table(folder, name), REMEDY)
        known = success_rows(runs)
        if not known:
            raise Failure("%s must say of some trial whether it was a success, column success is empty: use a "
                                 "plant with an angle" % nuisance_table(folder, name))
        rows.append((name,) + known[-1])
        seeds |= set(runs)
    frames = rows[0][1]
    for name, last, *_ in rows:
        if last != frames:
            raise Failure("%s must end at %d frames as that of %s, got %d: make it again with as many trials"
                                 % (nuisance_table(folder, name), frames, rows[0][0], last))
    if os.path.exists(os.path.join(folder, "trials.csv")):
        runs = {seed: trials for seed, trials in read_runs(folder, "trials.csv").items() if seed in seeds}
        rows[:0] = [("none",) + row for row in success_rows(runs) if row[0] == frames]
    return rows


def gravity_rows(folder):
    """Rows (method, frames, runs, success, interval, success_strict, interval) of the methods that were run."""
    return [(method,) + row for method, table in GRAVITY if os.path.exists(os.path.join(folder, table))
            for row in success_rows(read_runs(folder, table))]


def write_success(folder, sweep_folder, resumed=()):
    trials = os.path.join(folder, "trials.csv")
    write_csv(os.path.join(folder, "success_rate.csv"), ["frames", "runs"] + INTERVALS,
              success_rows(read_sweep(trials, REMEDY)))
    write_csv(os.path.join(folder, "times.csv"), ["seed", "train_s", "wall_s", "plan_ms_p99"],
              time_rows(trials, sweep_folder, resumed))


def write_variants(folder, part, labels):
    write_csv(os.path.join(folder, part + ".csv"),
              ["variant", "label", "frames", "seeds", "success", "success_se", "difference", "difference_se"],
              variant_rows(folder, part, labels))


def write_gravity(folder):
    write_csv(os.path.join(folder, "gravity.csv"), ["method", "frames", "runs"] + INTERVALS, gravity_rows(folder))


def write_nuisances(folder, names):
    write_csv(os.path.join(folder, "nuisances.csv"), ["nuisance", "frames", "runs"] + INTERVALS,
              nuisance_rows(folder, names))
