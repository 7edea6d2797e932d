# The fault table: every case of cases.py, several at a time, as DIR/faults.csv.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import concurrent.futures
import os
import time

from tqdm import tqdm

from ddm_launch.command import Failure, run_program
from ddm_launch.tables import write_csv
from ddm_qa.faults.cases import CASES
from ddm_qa.faults.run import FaultBench

COLUMNS = ["case", "phase", "fault", "expected", "observed", "passed"]

ABOUT = """\
Runs the experiment of the real nodes (lock-step, preset debug, seed 1) once undisturbed, then once for each case with
one fault in it, and then the same command again without the fault. Compares what is left with the undisturbed one."""

EPILOG = """\
DIR/faults.csv: case,phase,fault,expected,observed,passed, one row a case. DIR/logs/CASE.txt: what its launches said.
The folder of a case that failed stays in DIR. Exit code: 0 all passed, 1 not, 2 bad options. Cases that mount a small
or a read-only file system need root, and are left out without it."""


def selected(subset, only):
    cases = [case for case in CASES if subset == "all" or case.quick]
    return [case for case in cases if not only or any(word in case.name for word in only)]


def run_all(bench, cases, jobs):
    """{case name: what was observed}, with progress."""
    observed = {}
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = {pool.submit(bench.run, case): case for case in cases}
        try:
            for future in tqdm(concurrent.futures.as_completed(futures), total=len(cases), unit="case",
                               dynamic_ncols=True, disable=None):
                case = futures[future]
                observed[case.name] = future.result()
                if observed[case.name] != case.expected:
                    tqdm.write("failed: %s: expected '%s', got '%s'" % (case.name, case.expected, observed[case.name]))
        except BaseException:
            for future in futures:
                future.cancel()
            bench.stop()
            raise
    return observed


def table(cases, observed):
    """Rows of COLUMNS."""
    return [[case.name, case.phase, case.fault, case.expected, observed[case.name],
             int(observed[case.name] == case.expected)] for case in cases]


def run(arguments):
    start = time.monotonic()
    out = os.path.abspath(arguments.out)
    cases = selected(arguments.subset, arguments.only)
    if not cases:
        raise Failure("no case has one of these words in its name: %s" % ", ".join(arguments.only))
    skipped = [case for case in cases if case.root and os.geteuid() != 0]
    cases = [case for case in cases if case not in skipped]
    if skipped:
        print("SKIPPED, because these need root to mount file systems:\n - %s" % "\n - ".join(
            case.name for case in skipped))
    bench = FaultBench(out, arguments.patience)
    bench.make_reference()
    observed = run_all(bench, cases, arguments.jobs)
    write_csv(os.path.join(out, "faults.csv"), COLUMNS, table(cases, observed))
    failed = [case for case in cases if observed[case.name] != case.expected]
    print("table: %s (%.0f s)" % (os.path.join(out, "faults.csv"), time.monotonic() - start))
    print("%d passed, %d failed" % (len(cases) - len(failed), len(failed)))
    return 1 if failed else 0


def main():
    parser = argparse.ArgumentParser(prog="fault_table", description=ABOUT, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for table and logs")
    parser.add_argument("--subset", choices=["all", "quick"], default="all", help="quick: some of each class")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORDS", help="cases whose names have one of these")
    parser.add_argument("--jobs", type=int, default=3, metavar="N",
                        help="cases at a time, which wait more than they compute (default: %(default)s)")
    parser.add_argument("--patience", type=float, default=1.0, metavar="X",
                        help="all time limits times this, for slow machines (default: %(default)s)")
    arguments = parser.parse_args()
    if not arguments.patience > 0.0:
        parser.error("--patience must be > 0, got %g" % arguments.patience)
    if arguments.jobs < 1:
        parser.error("--jobs must be >= 1, got %d" % arguments.jobs)
    return run_program("fault_table", lambda: run(arguments))
