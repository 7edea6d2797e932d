# What a soak must reach, judged by its samples and frames.
# SPDX-License-Identifier: BSD-3-Clause
import collections

# Of a node after a trial. time_s: since the launch.
Sample = collections.namedtuple("Sample", "run node trial time_s rss_kb open_files")
# One row of bars.csv; passed: 0 or 1.
Bar = collections.namedtuple("Bar", "run bar measured passed")

GROWTH = 0.05  # of resident memory, since the first tenth of the trials: trial 30 of 300


def reference_trial(last):
    """Where a node is warm: a tenth of all trials."""
    return max(1, last // 10)


def by_node(samples):
    """{node: its samples, in the order of the trials}."""
    nodes = {}
    for sample in sorted(samples, key=lambda sample: sample.trial):
        nodes.setdefault(sample.node, []).append(sample)
    return nodes


def after(samples, trial):
    """The first sample of a node that is not before the end of a trial."""
    return next(sample for sample in samples if sample.trial >= trial)


def memory_bar(run, node, samples, last):
    first, end = after(samples, reference_trial(last)), samples[-1]
    growth = end.rss_kb / first.rss_kb - 1.0
    measured = "%.1f MB after trial %d, %.1f MB after trial %d: %+.1f %%" % (
        first.rss_kb / 1024.0, first.trial, end.rss_kb / 1024.0, end.trial, 100.0 * growth)
    return Bar(run, "resident memory of %s" % node, measured, int(end.trial == last and growth <= GROWTH))


def open_files_bar(run, node, samples, last):
    """A bag or a connection may be open just then: the most in the last tenth must have been there in the second."""
    tenth = reference_trial(last)
    early = max(sample.open_files for sample in samples if tenth <= sample.trial <= 2 * tenth)
    late = max(sample.open_files for sample in samples if sample.trial >= last - tenth)
    measured = "at most %d in trials %d to %d, %d in trials %d to %d" % (early, tenth, 2 * tenth, late, last - tenth,
                                                                         last)
    return Bar(run, "open files of %s" % node, measured, int(late <= early))


def frames_bar(run, frames):
    due = sum(max(row["due"], row["published"] or 0) for row in frames)
    lost = sum(row["lost"] for row in frames)
    return Bar(run, "lost frames", "%d of %d" % (lost, due), int(bool(frames) and lost == 0))


def judge(run, last, samples, frames):
    """All bars of a run. last: number of its last trial; samples, frames: of this run."""
    bars = []
    for node, of_node in by_node(samples).items():
        bars.append(memory_bar(run, node, of_node, last))
        bars.append(open_files_bar(run, node, of_node, last))
    return bars + [frames_bar(run, frames)]
