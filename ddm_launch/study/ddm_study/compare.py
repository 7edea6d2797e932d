# study compare: compares reproduced results with committed ones, row by row.
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
    """Compares a reproduced table of some seeds with the committed one. Returns (number of rows, first difference or
    ""). There are no rows if the table has no results of seeds."""
    old, new = (read_table(path).drop(columns=MAY_DIFFER, errors="ignore") for path in (committed, again))
    if "seed" not in new or len(new.columns) < 2:
        return 0, ""
    if set(old.columns) != set(new.columns):
        return len(new), "only one of the two files has the columns %s" % ", ".join(sorted(set(old.columns) ^ set(new.columns)))
    old, new = old[old.seed.isin(new.seed)].reset_index(drop=True), new[old.columns]
    if len(old) != len(new):
        return len(new), "%d rows of these seeds are committed, and %d were made" % (len(old), len(new))
    differs = (old != new) & ~(old.isna() & new.isna())
    for row, column in zip(*differs.values.nonzero()):
        return len(new), "row %d, seed %d: %s is %s in the committed file, and %s" % (
            row + 1, new.seed[row], old.columns[column], old.iloc[row, column], new.iloc[row, column])
    return len(new), ""


def work(options):
    num_tables = num_different = 0
    for again in sorted(glob.glob(os.path.join(options.again, "**", "*.csv"), recursive=True)):
        name = os.path.relpath(again, options.again)
        committed = os.path.join(options.committed, name)
        count, difference = compare(committed, again) if os.path.isfile(committed) else (0, "")
        if count > 0:
            print("%-7s  %s: %s" % ("differs" if difference else "equal", name, difference or "%d rows" % count))
            num_tables, num_different = num_tables + 1, num_different + bool(difference)
    if num_tables == 0:
        raise Failure("%s has no table of seeds that %s has too: make it again with the same command" % (
            options.again, options.committed))
    if num_different > 0:
        raise Failure("%d of %d tables differ: see above" % (num_different, num_tables))


def add_arguments(parser):
    parser.add_argument("committed", metavar="COMMITTED", help="folder in ddm_launch/results")
    parser.add_argument("again", metavar="AGAIN", help="folder that `study reproduce` wrote, of some of its seeds")
