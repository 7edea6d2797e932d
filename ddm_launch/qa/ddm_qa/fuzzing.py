# Fuzzing: every target several at a time, what they found as DIR/fuzzing.csv.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import glob
import os
import re
import subprocess
import time
import xml.etree.ElementTree as ElementTree

from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.tables import read_csv, write_csv
from ddm_model.plain_file import write_file
from ddm_qa.processes import side_by_side

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", ".."))
COLUMNS = ["target", "runs", "seconds", "corpus_files", "findings"]
# No input of a few kB is worth more memory than this: what takes more did not look before.
LIMITS = ["-malloc_limit_mb=64", "-rss_limit_mb=2048", "-timeout=30"]
REASONS = (r"^broken promise: .*", r"^.*runtime error: .*", r"^ *what\(\): .*", r"^==\d+== ?ERROR: .*")

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

# What came of a target; runs: without a finding. reason: what it said of a finding, in a line.
Outcome = collections.namedtuple("Outcome", "target runs seconds corpus_files findings reason")


class Target:
    """A program of libFuzzer: PROGRAMS/PACKAGE/fuzz_NAME."""

    def __init__(self, program):
        self.program, self.name = program, os.path.basename(program)[len("fuzz_"):]
        package = os.path.dirname(program)
        self.libraries = os.path.dirname(package)
        self.seeds = os.path.join(CHECKOUT, os.path.basename(package), "fuzz", "corpus", self.name)

    def command(self, corpus, findings, runs, seed):
        # Longest input: a few times what a seed has, since the time of a run grows with it.
        sizes = [4 * os.path.getsize(path) for path in glob.glob(os.path.join(self.seeds, "*"))]
        return [self.program, "-runs=%d" % runs, "-seed=%d" % seed, "-artifact_prefix=" + findings,
                "-max_len=%d" % max([256] + sizes)] + LIMITS + [corpus, self.seeds]


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
        self.processes, self.stopped = [], False
        for folder in ("corpus", "findings", "logs"):
            os.makedirs(os.path.join(out, folder), exist_ok=True)

    def run(self, target):
        """Returns its Outcome. Raises Failure if it cannot be run."""
        if self.stopped:
            raise Failure("target %s: not started" % target.name)
        log, corpus = (os.path.join(self.out, *names) for names in (("logs", target.name + ".txt"), ("corpus", target.name)))
        findings, start = os.path.join(self.out, "findings", target.name + "-"), time.monotonic()
        os.makedirs(corpus, exist_ok=True)
        before = set(glob.glob(glob.escape(findings) + "*"))
        # Those of this build: a workspace that was sourced has libraries of the same names, and they may load.
        libraries = [target.libraries] + os.environ.get("LD_LIBRARY_PATH", "").split(":")
        with open(log, "w") as stream:
            process = subprocess.Popen(
                target.command(corpus, findings, self.runs, self.seed), stdin=subprocess.DEVNULL, stdout=stream,
                stderr=stream, env=dict(os.environ, LD_LIBRARY_PATH=":".join(filter(None, libraries))))
            self.processes.append(process)
            code = process.wait()
        found = sorted(set(glob.glob(glob.escape(findings) + "*")) - before)
        if code != 0 and not found:
            raise Failure("target %s ended with code %d and kept no input: see %s" % (target.name, code, log))
        return Outcome(target.name, 0 if found else self.runs, time.monotonic() - start, len(os.listdir(corpus)), found,
                       reason(log) if found else "")

    def stop(self):
        self.stopped = True
        for process in self.processes:
            process.terminate()


def reason(log):
    with open(log, errors="replace") as stream:
        text = stream.read()
    said = [re.search(pattern, text, re.MULTILINE) for pattern in REASONS]
    return next((found.group(0).strip() for found in said if found), "see " + log)


def add_to_table(path, outcome):
    """Runs and seconds of earlier calls count, unless something was found, then or now."""
    rows = {row["target"]: row for row in read_csv(path, COLUMNS)} if os.path.exists(path) else {}
    before = rows.get(outcome.target)
    runs, seconds = outcome.runs, outcome.seconds
    if before and before["findings"] == "0" and not outcome.findings:
        runs, seconds = runs + int(before["runs"]), seconds + float(before["seconds"])
    rows[outcome.target] = dict(zip(COLUMNS, (outcome.target, runs, "%.0f" % seconds, outcome.corpus_files,
                                              len(outcome.findings))))
    write_csv(path, COLUMNS, [[rows[name][column] for column in COLUMNS] for name in sorted(rows)])


def junit(outcomes):
    failures = sum(1 for outcome in outcomes if outcome.findings)
    suite = ElementTree.Element("testsuite", failures=str(failures), errors="0")
    for outcome in outcomes:
        case = ElementTree.SubElement(suite, "testcase", classname="Fuzzing", name=outcome.target, status="run")
        if outcome.findings:
            ElementTree.SubElement(case, "failure").text = "%s: %s" % (outcome.findings[0], outcome.reason)
    return ElementTree.tostring(suite, encoding="unicode") + "\n"


def run(options):
    out, outcomes = os.path.abspath(options.out), []
    table = os.path.join(out, "fuzzing.csv")
    targets = find_targets(os.path.abspath(options.programs), options.only)
    bench = Bench(out, options.runs, options.seed)
    for _, outcome in side_by_side(bench.run, targets, options.jobs, bench.stop, "target"):
        add_to_table(table, outcome)
        outcomes.append(outcome)
    outcomes.sort()
    if options.junit:
        os.makedirs(os.path.dirname(os.path.abspath(options.junit)), exist_ok=True)
        write_file(options.junit, junit(outcomes))
    for outcome in outcomes:
        for finding in outcome.findings:
            print("FOUND by %s: %s\n      %s" % (outcome.target, finding, outcome.reason))
    findings = sum(len(outcome.findings) for outcome in outcomes)
    print("table: %s" % table)
    print("%d runs, %d findings" % (sum(outcome.runs for outcome in outcomes), findings))
    return 1 if findings else 0


def main(arguments=None):
    parser = program_parser("fuzz", ABOUT, EPILOG)
    parser.add_argument("--programs", required=True, metavar="PROGRAMS",
                        help="folder lib/ of a build with DDM_SANITIZE=address by clang")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for table, findings and corpus")
    parser.add_argument("--runs", type=number(int, 1), default=100000, metavar="N",
                        help="of each target (default: %(default)s)")
    parser.add_argument("--only", nargs="+", default=[], metavar="TARGET", help="these targets alone")
    parser.add_argument("--jobs", type=number(int, 1), default=2, metavar="N",
                        help="targets at a time (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0, metavar="S",
                        help="of the random draws; 0: another each time (default: %(default)s)")
    parser.add_argument("--junit", metavar="FILE", help="also write the verdicts as a result file of tests")
    options = parser.parse_args(arguments)
    return run_program("fuzz", lambda: run(options))
