# fault_table: runs all cases of fault_cases.py, several at a time, and writes DIR/faults.csv.
# SPDX-License-Identifier: BSD-3-Clause
from concurrent.futures import ThreadPoolExecutor, as_completed
import os
import time

from tqdm import tqdm

from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.run_folder import write_table
from ddm_qa.fault_cases import CASES, FAULT_OF_ROOT, QUICK
from ddm_qa.fault_run import FaultBench

COLUMNS = ["case", "phase", "fault", "expected", "observed", "passed"]

ABOUT = """\
Runs the experiment of the real nodes (lock-step, preset debug, seed 1) once undisturbed, then once for each case with
one fault in it, and then the same command again without the fault. Compares what is left with the undisturbed one."""

EPILOG = """\
DIR/faults.csv: case,phase,fault,expected,observed,passed, one row a case. DIR/logs/CASE.txt: what its launches said.
The folder of a case that failed stays in DIR. Exit code: 0 all passed, 1 not, 2 bad options. Cases that mount a small
file system need root, and are left out without it."""


def run(options):
    start, observed, out = time.monotonic(), {}, os.path.abspath(options.out)
    cases = [case for case in CASES if (options.subset == "all" or case.name in QUICK)
             and (not options.only or any(word in case.name for word in options.only))]
    if not cases:
        raise Failure("no case has one of these words in its name: %s" % ", ".join(options.only))
    if os.geteuid() != 0:
        skipped = [case for case in cases if case.fault == FAULT_OF_ROOT]
        cases = [case for case in cases if case not in skipped]
        print("SKIPPED, because these need root to mount file systems:\n - %s" % "\n - ".join(case.name for case in skipped))
    bench = FaultBench(out, options.patience)
    bench.make_reference()
    with ThreadPoolExecutor(options.jobs) as pool:
        futures = {pool.submit(bench.run, case): case for case in cases}
        try:
            for future in tqdm(as_completed(futures), total=len(cases), unit="case", dynamic_ncols=True, disable=None):
                case, result = futures[future], future.result()
                observed[case.name] = result
                if result != case.expected:
                    tqdm.write("failed: %s: expected '%s', got '%s'" % (case.name, case.expected, result))
        except BaseException:  # the user interrupts the program
            for future in futures:
                future.cancel()
            for launch in list(bench.launches):
                launch.stop()
            raise
    rows = [[*case[:4], observed[case.name], int(observed[case.name] == case.expected)] for case in cases]
    write_table(os.path.join(out, "faults.csv"), rows, COLUMNS)
    num_passed = sum(row[-1] for row in rows)
    print("table: %s (%.0f s)" % (os.path.join(out, "faults.csv"), time.monotonic() - start))
    print("%d passed, %d failed" % (num_passed, len(rows) - num_passed))
    return 0 if num_passed == len(rows) else 1


def main():
    parser = program_parser("fault_table", ABOUT, EPILOG)
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for table and logs")
    parser.add_argument("--subset", choices=["all", "quick"], default="all", help="quick: some of each class")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORDS", help="cases whose names have one of these")
    parser.add_argument("--jobs", type=number(int, 1), default=3, metavar="N",
                        help="cases at a time, which wait more than they compute (default: %(default)s)")
    parser.add_argument("--patience", type=number(float, 0.01), default=1.0, metavar="X",
                        help="all time limits but a robot's times this, for slow machines (default: %(default)s)")
    options = parser.parse_args()
    return run_program("fault_table", lambda: run(options))
