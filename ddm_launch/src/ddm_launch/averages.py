# Computes means over experiments, with standard errors, confidence intervals and tests.
# SPDX-License-Identifier: BSD-3-Clause
import math
import statistics

import numpy as np
import pandas


def success_rates(trials):
    """Success rate over the seeds at each number of frames. trials: table of read_trials().

    Returns a table with the index frames and the columns rate, se, runs, low and high (ends of Wilson's interval).
    Trials with unknown success are excluded. The standard error of a rate p over n experiments is

      se = sqrt(p (1 - p) / (n - 1)),   as in the paper's Fig. 8, and 0 for a single experiment
    """
    groups = trials.dropna(subset=["success"]).groupby("frames").success
    rate, runs = groups.mean(), groups.size()
    low, high = wilson_interval(rate, runs)
    return pandas.DataFrame({"rate": rate, "se": np.sqrt(rate * (1.0 - rate) / (runs - 1).clip(lower=1)), "runs": runs,
                             "low": low, "high": high})


def wilson_interval(rate, n, confidence=0.95):
    """Wilson's confidence interval (low, high) for a rate p_hat over n independent experiments: all rates p with

      |p_hat - p| <= z sqrt(p (1 - p) / n),   z: quantile of N(0, 1), 1.96 at 95 %

    E. B. Wilson, "Probable inference, the law of succession, and statistical inference", J. Am. Stat. Assoc. 22 (1927).
    Unlike the standard error, the interval keeps a positive width if all experiments succeed.
    """
    z = statistics.NormalDist().inv_cdf(0.5 + 0.5 * confidence)
    centre = (rate + z * z / (2.0 * n)) / (1.0 + z * z / n)
    half = z / (1.0 + z * z / n) * np.sqrt(rate * (1.0 - rate) / n + z * z / (4.0 * n * n))
    return np.maximum(0.0, centre - half), np.minimum(1.0, centre + half)


def mean_and_error(values):
    """Mean of the values and its standard error s / sqrt(n), where s is the sample standard deviation. The error of a
    single value is 0."""
    mean = math.fsum(values) / len(values)
    return mean, statistics.stdev(values, mean) / math.sqrt(len(values)) if len(values) > 1 else 0.0


def sign_test(differences):
    """Exact two-sided p-value of the hypothesis that paired differences are positive and negative with equal
    probability. Zeros are excluded.

    For successes (1) and failures (0) this is McNemar's exact test. W. J. Conover, "Practical Nonparametric Statistics"
    (1999), sec. 3.4 and 3.5.
    """
    more, fewer = sum(d > 0 for d in differences), sum(d < 0 for d in differences)
    n = more + fewer
    return min(1.0, 2.0 * sum(math.comb(n, k) for k in range(min(more, fewer) + 1)) / 2 ** n)


def holm(p_values):
    """Adjusts p-values of several tests, so that the probability of at least one false finding is at most the level of
    the test.

    The i-th smallest of m p-values (i = 0, 1, ...) is multiplied by m - i; no adjusted p-value is smaller than that of
    a smaller p-value. S. Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Stat. 6 (1979).
    """
    adjusted, largest = [0.0] * len(p_values), 0.0
    for rank, index in enumerate(sorted(range(len(p_values)), key=p_values.__getitem__)):
        largest = adjusted[index] = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
    return adjusted
