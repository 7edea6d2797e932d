# Fuzzing: every target several at a time, what they found as DIR/fuzzing.csv.
# SPDX-License-Identifier: BSD-3-Clause
import collections
import glob
import os
import re
import subprocess
import time
from xml.sax.saxutils import escape

from ddm_launch.command import Failure, number, program_parser, run_program
from ddm_launch.tables import write_csv
from ddm_model.plain_file import write_file
from ddm_qa.processes import side_by_side

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", ".."))
# No input of a few kB is worth more memory than this: what takes more did not look before.
LIMITS = ["-malloc_limit_mb=64", "-rss_limit_mb=2048", "-timeout=30"]
REASONS = re.compile(r"^(broken promise: .*|.*runtime error: .*| *what\(\): .*|==\d+== ?ERROR: .*)", re.MULTILINE)

ABOUT = """\
Feeds bytes that nobody would write to everything that reads bytes from outside: files, messages, configurations. Each
package has a program of libFuzzer with the address and undefined behaviour sanitizers, and each of its targets a folder
of seeds, PACKAGE/fuzz/corpus/TARGET. A target also checks what must hold for what is accepted, and that a refusal says
why."""

EPILOG = """\
DIR/fuzzing.csv    a row a target: runs without a finding, seconds, files in its corpus, findings
DIR/findings/      the inputs that were found, by target. Again: FUZZ_TARGET=TARGET PROGRAMS/PACKAGE/PACKAGE_fuzz FILE
DIR/corpus/        what was learned, from which the next call continues
DIR/logs/          what each target said
Exit code: 0 nothing was found, 1 something was, 2 bad options."""

Target = collections.namedtuple("Target", "name package seeds")
# What came of a target; runs: without a finding. findings: files, with a line about the first.
Outcome = collections.namedtuple("Outcome", "target runs seconds corpus_files findings")


def find_targets(only):
    """All that have seeds, by name."""
    folders = sorted(glob.glob(os.path.join(CHECKOUT, "ddm_*", "fuzz", "corpus", "*")))
    targets = [Target(os.path.basename(path), os.path.relpath(path, CHECKOUT).split(os.sep)[0], path) for path in folders]
    unknown = sorted(set(only) - {target.name for target in targets})
    if unknown:
        raise Failure("unknown target %s: there are %s" % (
            ", ".join(unknown), ", ".join(target.name for target in targets)))
    return [target for target in targets if not only or target.name in only]


class Bench:
    """Runs targets in DIR."""

    def __init__(self, programs, out, runs, seed):
        self.programs, self.out, self.runs, self.seed = programs, out, runs, seed
        self.processes = []
        for folder in ("findings", "logs"):
            os.makedirs(os.path.join(out, folder), exist_ok=True)

    def run(self, target):
        """Returns its Outcome. Raises Failure if it cannot be run."""
        program = os.path.join(self.programs, target.package, target.package + "_fuzz")
        if not os.path.exists(program):
            raise Failure("target %s: there is no program %s. Remedy: bash %s --fuzz, which builds it" % (
                target.name, program, os.path.join(CHECKOUT, "ddm_launch", "scripts", "test.sh")))
        log, corpus = (os.path.join(self.out, *names) for names in (("logs", target.name + ".txt"), ("corpus", target.name)))
        findings, start = os.path.join(self.out, "findings", target.name + "-"), time.monotonic()
        os.makedirs(corpus, exist_ok=True)
        before = set(glob.glob(glob.escape(findings) + "*"))
        # Longest input: a few times what a seed has, since the time of a run grows with it.
        longest = max([256] + [4 * os.path.getsize(path) for path in glob.glob(os.path.join(target.seeds, "*"))])
        # Libraries of this build: a workspace that was sourced has some of the same names, and they may load.
        libraries = [self.programs] + list(filter(None, os.environ.get("LD_LIBRARY_PATH", "").split(":")))
        with open(log, "w") as stream:
            process = subprocess.Popen(
                [program, "-runs=%d" % self.runs, "-seed=%d" % self.seed, "-max_len=%d" % longest,
                 "-artifact_prefix=" + findings, *LIMITS, corpus, target.seeds],
                stdin=subprocess.DEVNULL, stdout=stream, stderr=stream,
                env=dict(os.environ, FUZZ_TARGET=target.name, LD_LIBRARY_PATH=":".join(libraries)))
            self.processes.append(process)
            code = process.wait()
        found = sorted(set(glob.glob(glob.escape(findings) + "*")) - before)
        if code != 0 and not found:
            raise Failure("target %s ended with code %d and kept no input: see %s" % (target.name, code, log))
        if found:
            with open(log, errors="replace") as stream:
                reason = REASONS.search(stream.read())
            found[0] += ": %s" % (reason.group(0).strip() if reason else "see " + log)
        return Outcome(target.name, 0 if found else self.runs, "%.0f" % (time.monotonic() - start),
                       len(os.listdir(corpus)), found)

    def stop(self):
        for process in self.processes:
            process.terminate()


def junit(outcomes):
    """The verdicts as a result file of tests."""
    cases = ['  <testcase classname="Fuzzing" name="%s">%s</testcase>\n' % (
        outcome.target, "".join("<failure>%s</failure>" % escape(finding) for finding in outcome.findings))
        for outcome in outcomes]
    return '<testsuite name="fuzzing" failures="%d" errors="0">\n%s</testsuite>\n' % (
        sum(1 for outcome in outcomes if outcome.findings), "".join(cases))


def run(options):
    out = os.path.abspath(options.out)
    bench = Bench(os.path.abspath(options.programs), out, options.runs, options.seed)
    outcomes = sorted(outcome for _, outcome in side_by_side(bench.run, find_targets(options.only), os.cpu_count(),
                                                             bench.stop, "target"))
    write_csv(os.path.join(out, "fuzzing.csv"), Outcome._fields,
              [[*outcome[:-1], len(outcome.findings)] for outcome in outcomes])
    if options.junit:
        os.makedirs(os.path.dirname(os.path.abspath(options.junit)), exist_ok=True)
        write_file(options.junit, junit(outcomes))
    findings = [finding for outcome in outcomes for finding in outcome.findings]
    for finding in findings:
        print("FOUND " + finding)
    print("table: %s" % os.path.join(out, "fuzzing.csv"))
    print("%d runs, %d findings" % (sum(outcome.runs for outcome in outcomes), len(findings)))
    return 1 if findings else 0


def main():
    parser = program_parser("fuzz", ABOUT, EPILOG)
    parser.add_argument("--programs", required=True, metavar="PROGRAMS",
                        help="folder lib/ of a build with DDM_SANITIZE=address by clang")
    parser.add_argument("--out", required=True, metavar="DIR", help="folder for table, findings and corpus")
    parser.add_argument("--runs", type=number(int, 1), default=100000, metavar="N",
                        help="of each target (default: %(default)s)")
    parser.add_argument("--only", nargs="+", default=[], metavar="TARGET", help="these targets alone")
    parser.add_argument("--seed", type=int, default=0, metavar="S",
                        help="of the random draws; 0: another each time (default: %(default)s)")
    parser.add_argument("--junit", metavar="FILE", help="also write the verdicts as a result file of tests")
    options = parser.parse_args()
    return run_program("fuzz", lambda: run(options))
