# Compares results that were made again with committed ones, row by row.
# SPDX-License-Identifier: BSD-3-Clause
import glob
import os

from ddm_launch.command import Failure
from ddm_study.results import read_table

ABOUT = """\
Compares results that were made again, of some of the seeds, with committed ones: each CSV file in AGAIN that has rows of
seeds. Times and versions may differ, all else must not. Another processor, compiler or build setting may round differently.

example, two seeds of each sweep of results/paper:
  rosrun ddm_launch study reproduce paper SEEDS=2 PILCO= --out again
  rosrun ddm_launch study compare "$(rospack find ddm_launch)/results/paper" again/paper"""
MAY_DIFFER = ["version", "train_s", "wall_s", "plan_ms_median", "plan_ms_p99", "gp_s", "policy_search_s"]


def compare(committed, again):
    """(number of rows, the first difference or None) of a table that was made again for some seeds; no rows: it has no
    seeds."""
    old, new = (read_table(path).drop(columns=MAY_DIFFER, errors="ignore") for path in (committed, again))
    if "seed" not in new or len(new.columns) < 2:
        return 0, None
    in_one = set(old.columns) ^ set(new.columns)
    if in_one:
        return len(new), "only one of the two files has the columns %s" % ", ".join(sorted(in_one))
    old = old[old.seed.isin(new.seed)].reset_index(drop=True)
    if len(old) != len(new):
        return len(new), "%d rows of these seeds are committed, and %d were made" % (len(old), len(new))
    new = new[old.columns]
    differs = (old != new) & ~(old.isna() & new.isna())
    for row, name in zip(*differs.values.nonzero()):
        name = old.columns[name]
        return len(new), "row %d, seed %d: %s is %s in the committed file, and %s" % (
            row + 1, new.seed[row], name, old[name][row], new[name][row])
    return len(new), None


def work(options):
    paths = glob.glob(os.path.join(options.again, "**", "*.csv"), recursive=True)
    names = sorted(os.path.relpath(path, options.again) for path in paths)
    num_compared = num_different = 0
    for name in names:
        if os.path.isfile(os.path.join(options.committed, name)):
            count, difference = compare(os.path.join(options.committed, name), os.path.join(options.again, name))
            if count:
                print("%-7s  %s: %s" % ("differs" if difference else "equal", name, difference or "%d rows" % count))
            num_compared += count > 0
            num_different += difference is not None
    if not num_compared:
        raise Failure("%s has no table of seeds that %s has too: make it again with the same command" % (
            options.again, options.committed))
    if num_different:
        raise Failure("%d of %d tables differ: see above" % (num_different, num_compared))


def add_arguments(parser):
    parser.add_argument("committed", metavar="COMMITTED", help="folder in ddm_launch/results")
    parser.add_argument("again", metavar="AGAIN", help="folder that `study reproduce` wrote, of some of its seeds")
