# Means over experiments, with their standard errors.
# SPDX-License-Identifier: BSD-3-Clause
import math


def success_rates(runs):
    """The rate of success over runs, for each number of frames that any run has.

    runs: one list of Trial per run. Trials whose success is not known are left out.
    Returns rows (frames, rate, standard error, number of runs), ascending. The standard error of a rate p over
    n runs is sqrt(p (1 - p) / (n - 1)), as in the paper's Fig. 8; 0 for a single run.
    """
    by_frames = {}
    for trials in runs:
        for trial in trials:
            if trial.success is not None:
                by_frames.setdefault(trial.frames, []).append(trial.success)
    rows = []
    for frames, successes in sorted(by_frames.items()):
        n = len(successes)
        rate = sum(successes) / n
        rows.append((frames, rate, math.sqrt(rate * (1.0 - rate) / (n - 1)) if n > 1 else 0.0, n))
    return rows


def mean_and_error(values):
    """Mean of these numbers and its standard error, s / sqrt(n) with the sample's s; 0 for a single number."""
    n = len(values)
    mean = math.fsum(values) / n
    if n == 1:
        return mean, 0.0
    return mean, math.sqrt(math.fsum((value - mean) ** 2 for value in values) / (n - 1) / n)
