# Compares results that were made again with committed ones, row by row.
# SPDX-License-Identifier: BSD-3-Clause
import csv
import os

from ddm_launch.command import Failure, program_parser, run_program
from ddm_launch.settings import read_yaml
from ddm_launch.tables import read_csv

ABOUT = """\
Compares results that were made again, of some of the seeds, with committed ones: each CSV file in AGAIN that has rows of
seeds. Times and versions may differ, all else must not. Another compiler or build setting may round differently."""
EPILOG = """\
example, two seeds of each sweep of results/efficient:
  rosrun ddm_launch reproduce_efficient --seeds 300:302 --pilco-seeds 0 --only efficient gravity nuisances tasks --out again
  rosrun ddm_launch compare_results "$(rospack find ddm_launch)/results/efficient" again"""

MAY_DIFFER = {"version", "train_s", "wall_s", "plan_ms_median", "plan_ms_p99", "gp_s", "policy_search_s"}


def header_of(path):
    """Its columns."""
    with open(path, newline="") as stream:
        return next(csv.reader(stream), [])


def tables(committed, again):
    """Paths of the CSV files with rows of seeds that both folders have, relative to them, but for those of times alone."""
    found = []
    for parent, _, names in os.walk(committed):
        for name in names:
            path = os.path.relpath(os.path.join(parent, name), committed)
            if name.endswith(".csv") and os.path.isfile(os.path.join(again, path)):
                columns = set(header_of(os.path.join(again, path)))
                if "seed" in columns and columns - MAY_DIFFER - {"seed"}:
                    found.append(path)
    return sorted(found)


def compare(committed, again):
    """(number of rows, what differs first or None) of one table that was made again for some seeds."""
    old_columns, new_columns = (set(header_of(path)) - MAY_DIFFER for path in (committed, again))
    in_one = old_columns ^ new_columns
    if in_one:
        return 0, "only one of the two files has the columns %s" % ", ".join(sorted(in_one))
    columns = [name for name in header_of(again) if name in old_columns & new_columns]
    rows = read_csv(again, columns)
    seeds = {row["seed"] for row in rows}
    due = [row for row in read_csv(committed, columns) if row["seed"] in seeds]
    if len(due) != len(rows):
        return len(rows), "%d rows of these seeds are committed, and %d were made" % (len(due), len(rows))
    for number, (old, new) in enumerate(zip(due, rows), 1):
        for name in columns:
            if old[name] != new[name]:
                return len(rows), "row %d, seed %s: %s is %s in the committed file, and %s" % (
                    number, new["seed"], name, old[name], new[name])
    return len(rows), None


def processors(folder):
    steps = read_yaml(os.path.join(folder, "machine.yaml")).get("steps") or {}
    return {step.get("cpu") for step in steps.values()}


def work(options):
    for folder in (options.committed, options.again):
        if not os.path.isdir(folder):
            raise Failure("there is no folder %s: give one that reproduce_paper or reproduce_efficient wrote" % folder)
    names = tables(options.committed, options.again)
    if not names:
        raise Failure("%s has no table of seeds that %s has too: make it again with the same command" % (
            options.again, options.committed))
    num_different = 0
    for name in names:
        count, difference = compare(os.path.join(options.committed, name), os.path.join(options.again, name))
        print("%-7s  %s: %s" % ("differs" if difference else "equal", name, difference or "%d rows" % count), flush=True)
        num_different += difference is not None
    if num_different == 0:
        return 0
    unknown = processors(options.again) - processors(options.committed)
    raise Failure("%d of %d tables differ%s" % (num_different, len(names), "; the committed ones were not made on %s" % (
        ", ".join(map(str, sorted(unknown, key=str)))) if unknown else ""))


def main(arguments=None):
    parser = program_parser("compare_results", ABOUT, EPILOG)
    parser.add_argument("committed", metavar="COMMITTED", help="folder in ddm_launch/results")
    parser.add_argument("again", metavar="AGAIN", help="folder that the same program wrote, of some of its seeds")
    options = parser.parse_args(arguments)
    return run_program("compare_results", lambda: work(options))
