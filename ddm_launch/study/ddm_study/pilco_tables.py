# Tables of PILCO in the reproduction: success by policy, computing times, and what holds against the authors' runs.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
import statistics

from ddm_launch.command import Failure
from ddm_launch.run_folder import read_sweep
from ddm_launch.tables import read_csv

LABELS = {"pilco_state": "PILCO, state", "pilco_state_sparse": "PILCO, state, sparse GP",
          "pilco_features": "PILCO, features", "pilco_pca": "PILCO, PCA"}  # by folder of reproduce_paper
ON_THE_STATE = ("pilco_state", "pilco_state_sparse")
AUTHORS = "UCL-SML/pilco-matlab, stored runs"
AUTHORS_SEEDS = 12
AUTHORS_SUCCESSES = (11, 12, 12, 12, 12, 12, 12, 12, 12, 12, 12, 11, 12, 12, 9, 10)  # of policy 1, 2, ...
AUTHORS_HOURS = (3.75, 10.5)  # policies 2 to 10 together: median and largest of the seeds
GROUPS = ((1, 1), (2, 6))  # policies that the targets look at together
TARGET_FIRST, TARGET_LATER = 10, 57  # of 12 and of 60 successes
NUM_TIMED = 10  # policies whose times are added up
TARGET_TIME_S = 30.0 * 60.0
REMEDY = "rosrun ddm_launch reproduce_paper writes it"


def of_authors(first, last):
    """(successes, runs) of the authors' policies `first` to `last`, on the true state."""
    counts = AUTHORS_SUCCESSES[first - 1:last]
    return sum(counts), AUTHORS_SEEDS * len(counts)


def range_text(first, last):
    return "%d" % first if first == last else "%d to %d" % (first, last)


def read_runs(folder, name):
    return read_sweep(os.path.join(folder, name, "trials.csv"), REMEDY)


def greedy_runs(runs, first=1, last=math.inf):
    """The trials whose policies are `first` to `last` and whose success is known, of all seeds together."""
    return [trial for by_seed in runs.values() for trial in by_seed
            if first <= trial.trial + 1 <= last and trial.success is not None]


def num_successes(trials):
    return sum(trial.success for trial in trials)


def success_rows(folder, names):
    """Rows (method, policies, frames, successes, runs, authors' successes, authors' runs): each policy, then groups."""
    rows = []
    for name in names:
        runs = read_runs(folder, name)
        num_policies = 1 + max(trial.trial for trials in runs.values() for trial in trials)
        groups = [(k, k) for k in range(1, num_policies + 1)]
        for first, last in groups + [group for group in GROUPS if group[0] < group[1] <= num_policies]:
            trials = greedy_runs(runs, first, last)
            if trials:
                frames = sorted(trial.frames for trial in trials)
                comparable = name in ON_THE_STATE and last <= len(AUTHORS_SUCCESSES)
                rows.append((name, range_text(first, last), range_text(frames[0], frames[-1]), num_successes(trials),
                             len(trials)) + (of_authors(first, last) if comparable else ("", "")))
    return rows


def times_by_seed(path, column):
    """(the times of each seed, trial after trial; the frames of each trial) of a table with a row per seed and trial.

    Raises Failure if a seed lacks a trial that others have.
    """
    times, frames = {}, {}
    for row in read_csv(path, {"seed": int, "trial": int, "frames": int, column: float}, REMEDY):
        times.setdefault(row["seed"], {})[row["trial"]] = row[column]
        frames[row["trial"]] = row["frames"]
    trials = range(len(frames))
    for seed, by_trial in times.items():
        if sorted(by_trial) != list(trials):
            raise Failure("%s: seed %d must have the trials 0 to %d, once each: run it to its end" % (
                path, seed, max(frames)))
    return [[by_trial[k] for k in trials] for by_trial in times.values()], [frames[k] for k in trials]


def total_seconds(folder, name):
    """(number of policies, their frames, seconds of each seed) of learning the first policies, at most NUM_TIMED."""
    seconds, frames = times_by_seed(os.path.join(folder, name, "trials.csv"), "train_s")
    count = min(NUM_TIMED, len(frames))
    return count, frames[count - 1], [sum(of_seed[:count]) for of_seed in seconds]


def time_rows(folder, names):
    """Rows (what, frames, median, largest, unit, source), as those of DDM + MPC."""
    rows = []
    for name in names:
        def add(what, frames, values, unit, table="trials.csv"):
            rows.append(("%s: %s" % (LABELS[name], what), frames, statistics.median(values), max(values), unit,
                         "%s/%s" % (name, table)))

        count, total_frames, totals = total_seconds(folder, name)
        for table, column, what in (("trials.csv", "train_s", "training"),
                                    ("policy_search.csv", "gp_s", "of it Gaussian process"),
                                    ("policy_search.csv", "policy_search_s", "of it policy search")):
            seconds, frames = times_by_seed(os.path.join(folder, name, table), column)
            for trial in sorted({0, count - 1}):
                add(what, frames[trial], [of_seed[trial] for of_seed in seconds], "s", table)
        add("training of the first %d policies" % count, total_frames, [total / 60.0 for total in totals], "min")
        plan_ms, _ = times_by_seed(os.path.join(folder, name, "trials.csv"), "plan_ms_median")
        add("control, median of a greedy run", "all", sum(plan_ms, []), "ms")
    if names:
        rows.append(("PILCO on the state, policies 2 to 10 of the authors", 125 * NUM_TIMED) + AUTHORS_HOURS +
                    ("h", AUTHORS + " (times of the files, %d seeds at once)" % AUTHORS_SEEDS))
    return rows


def agreement_rows(folder, names):
    """Rows (point, target, here, True | False | None); only PILCO on the state, full GP, has targets and verdicts."""
    rows = []
    for name in names:
        runs, label, has_targets = read_runs(folder, name), LABELS[name], name == "pilco_state"
        for (first, last), target in zip(GROUPS if has_targets else (), (TARGET_FIRST, TARGET_LATER)):
            authors, of_runs = of_authors(first, last)
            trials = greedy_runs(runs, first, last)
            rows.append(("%s: successes of policy %s" % (label, range_text(first, last)),
                         ">= %d of %d (authors: %d)" % (target, of_runs, authors),
                         "%d of %d" % (num_successes(trials), len(trials)),
                         num_successes(trials) >= target if len(trials) == of_runs else None))
        if not has_targets:
            trials = greedy_runs(runs)
            rows.append((label + ": successes of all policies",
                         "reported" if name in ON_THE_STATE else "reported (paper: 0)",
                         "%d of %d" % (num_successes(trials), len(trials)), None))
        count, _, totals = total_seconds(folder, name)
        known = has_targets and (count, len(totals)) == (NUM_TIMED, AUTHORS_SEEDS)
        rows.append(("%s: time to policy %d, largest of %d seed%s" % (label, count, len(totals), "s" * (len(totals) > 1)),
                     "< %g min (authors: 3 to 10 h)" % (TARGET_TIME_S / 60.0) if has_targets else "reported",
                     "%.1f min (median %.1f)" % (max(totals) / 60.0, statistics.median(totals) / 60.0),
                     max(totals) < TARGET_TIME_S if known else None))
    return rows
