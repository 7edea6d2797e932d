# Fuzzing: every target several at a time, what they found as DIR/fuzzing.csv.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import collections
import concurrent.futures
import glob
import os
import re
import subprocess
import time
import xml.etree.ElementTree as ElementTree

from tqdm import tqdm

from ddm_launch.command import Failure, run_program
from ddm_launch.tables import read_csv, write_csv
from ddm_model.plain_file import write_file

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", ".."))
COLUMNS = ["target", "runs", "seconds", "corpus_files", "findings"]
# No input of a few kB is worth more memory than this: what takes more did not look before.
LIMITS = ["-malloc_limit_mb=64", "-rss_limit_mb=2048", "-timeout=30"]

ABOUT = """\
Feeds bytes that nobody would write to everything that reads bytes from outside: files, messages, parameters. Each
target is a program of libFuzzer with the address and undefined behaviour sanitizers, in the folder fuzz/ of the
package whose input it is. It also checks what must hold for what is accepted, and that a refusal says why."""

EPILOG = """\
DIR/fuzzing.csv    a row a target: runs since its last finding, seconds, files in its corpus, findings of this call
DIR/findings/      the inputs that were found, by target. Again: PROGRAMS/PACKAGE/fuzz_TARGET FILE
DIR/corpus/        what was learned, from which the next call continues; its runs are added to the table
DIR/logs/          what each target said
Exit code: 0 nothing was found, 1 something was, 2 bad options."""


class Target:
    """A program of libFuzzer: PROGRAMS/PACKAGE/fuzz_NAME."""

    def __init__(self, program):
        self.libraries = os.path.dirname(os.path.dirname(program))
        self.program = program
        self.name = os.path.basename(program)[len("fuzz_"):]
        self.package = os.path.basename(os.path.dirname(program))
        self.seeds = os.path.join(CHECKOUT, self.package, "fuzz", "corpus", self.name)

    def max_bytes(self):
        """Of an input: a few times what a seed has, since the time of a run grows with it."""
        return max([256] + [4 * os.path.getsize(path) for path in glob.glob(os.path.join(self.seeds, "*"))])


# What came of a target; runs: without a finding.
Outcome = collections.namedtuple("Outcome", "target runs seconds corpus_files findings log")


def find_targets(programs, only):
    targets = [Target(path) for path in sorted(glob.glob(os.path.join(programs, "ddm_*", "fuzz_*")))]
    if not targets:
        raise Failure("there is no fuzz target in %s. Remedy: bash %s, which builds them" % (
            programs, os.path.join(CHECKOUT, "ddm_launch", "qa", "fuzz.sh")))
    names = [target.name for target in targets]
    unknown = [name for name in only if name not in names]
    if unknown:
        raise Failure("unknown target %s: there are %s" % (", ".join(unknown), ", ".join(names)))
    for target in targets:
        if not os.path.isdir(target.seeds):
            raise Failure("target %s has no seeds in %s" % (target.name, target.seeds))
    return [target for target in targets if not only or target.name in only]


class Bench:
    """Runs targets in DIR."""

    def __init__(self, out, runs, seed):
        self.out, self.runs, self.seed = out, runs, seed
        self.processes = {}  # by name of the target
        self.stopped = False
        for folder in ("corpus", "findings", "logs"):
            os.makedirs(os.path.join(out, folder), exist_ok=True)

    def log(self, target):
        return os.path.join(self.out, "logs", target.name + ".txt")

    def run(self, target):
        """Returns its Outcome. Raises Failure if it cannot be run."""
        corpus, start = os.path.join(self.out, "corpus", target.name), time.monotonic()
        os.makedirs(corpus, exist_ok=True)
        findings = os.path.join(self.out, "findings", target.name + "-")
        before = set(glob.glob(glob.escape(findings) + "*"))
        command = [target.program, "-runs=%d" % self.runs, "-seed=%d" % self.seed, "-artifact_prefix=" + findings,
                   "-max_len=%d" % target.max_bytes()] + LIMITS + [corpus, target.seeds]
        # Those of this build: a workspace that was sourced has libraries of the same names, and they may load.
        libraries = [target.libraries] + os.environ.get("LD_LIBRARY_PATH", "").split(":")
        environment = dict(os.environ, LD_LIBRARY_PATH=":".join(filter(None, libraries)))
        with open(self.log(target), "w") as log:
            if self.stopped:
                raise Failure("target %s: not started" % target.name)
            process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
            self.processes[target.name] = process
            code = process.wait()
        found = sorted(set(glob.glob(glob.escape(findings) + "*")) - before)
        if code != 0 and not found:
            raise Failure("target %s ended with code %d and kept no input: see %s" % (
                target.name, code, self.log(target)))
        return Outcome(target, 0 if found else self.runs, time.monotonic() - start, len(os.listdir(corpus)), found,
                       self.log(target))

    def stop(self):
        self.stopped = True
        for process in list(self.processes.values()):
            process.terminate()


def run_all(bench, targets, jobs, keep):
    """Outcomes in the order of the targets, each given to keep() when it is there."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(bench.run, target) for target in targets]
        try:
            for future in tqdm(concurrent.futures.as_completed(futures), total=len(targets), unit="target",
                               dynamic_ncols=True, disable=None):
                keep(future.result())
            return [future.result() for future in futures]
        except BaseException:
            for future in futures:
                future.cancel()
            bench.stop()
            raise


def read_table(path):
    """{target: row}, empty if there is no table yet."""
    return {row["target"]: row for row in read_csv(path, COLUMNS)} if os.path.exists(path) else {}


def add_to_table(path, outcome):
    """Runs and seconds of earlier calls count, unless something was found, then or now."""
    rows, name = read_table(path), outcome.target.name
    before = rows.get(name)
    goes_on = before and before["findings"] == "0" and not outcome.findings
    runs, seconds = (int(before["runs"]), float(before["seconds"])) if goes_on else (0, 0.0)
    rows[name] = dict(zip(COLUMNS, (name, runs + outcome.runs, "%.0f" % (seconds + outcome.seconds),
                                    outcome.corpus_files, len(outcome.findings))))
    write_csv(path, COLUMNS, [[rows[name][column] for column in COLUMNS] for name in sorted(rows)])


def reason(outcome):
    """What a target said of its finding, in a line."""
    with open(outcome.log, errors="replace") as stream:
        text = stream.read()
    for pattern in (r"^broken promise: .*", r"^.*runtime error: .*", r"^ *what\(\): .*", r"^==\d+== ?ERROR: .*"):
        found = re.search(pattern, text, re.MULTILINE)
        if found:
            return found.group(0).strip()
    return "see " + outcome.log


def junit(outcomes):
    failures = sum(1 for outcome in outcomes if outcome.findings)
    suite = ElementTree.Element("testsuite", failures=str(failures), errors="0")
    for outcome in outcomes:
        case = ElementTree.SubElement(suite, "testcase", classname="Fuzzing", name=outcome.target.name, status="run")
        if outcome.findings:
            ElementTree.SubElement(case, "failure").text = "%s: %s" % (outcome.findings[0], reason(outcome))
    return ElementTree.tostring(suite, encoding="unicode") + "\n"


def run(arguments):
    out = os.path.abspath(arguments.out)
    table = os.path.join(out, "fuzzing.csv")
    targets = find_targets(os.path.abspath(arguments.programs), arguments.only)
    bench = Bench(out, arguments.runs, arguments.seed)
    outcomes = run_all(bench, targets, arguments.jobs, lambda outcome: add_to_table(table, outcome))
    if arguments.junit:
        os.makedirs(os.path.dirname(os.path.abspath(arguments.junit)), exist_ok=True)
        write_file(os.path.abspath(arguments.junit), junit(outcomes))
    for outcome in outcomes:
        for finding in outcome.findings:
            print("FOUND by %s: %s\n      %s" % (outcome.target.name, finding, reason(outcome)))
    findings = sum(len(outcome.findings) for outcome in outcomes)
    print("table: %s" % table)
    print("%d runs, %d findings" % (sum(outcome.runs for outcome in outcomes), findings))
    return 1 if findings else 0


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="fuzz", description=ABOUT, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, metavar="PROGRAMS", help="folder lib/ of a build with DDM_FUZZ")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for table, findings and corpus")
    parser.add_argument("--runs", type=int, default=100000, metavar="N", help="of each target (default: %(default)s)")
    parser.add_argument("--only", nargs="+", default=[], metavar="TARGET", help="these targets alone")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="targets at a time (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, metavar="S",
                        help="of the random draws; 0: another each time (default: %(default)s)")
    parser.add_argument("--junit", metavar="FILE", help="also write the verdicts as a result file of tests")
    arguments = parser.parse_args(arguments)
    for name in ("runs", "jobs"):
        if getattr(arguments, name) < 1:
            parser.error("--%s must be >= 1, got %d" % (name, getattr(arguments, name)))
    return run_program("fuzz", lambda: run(arguments))
