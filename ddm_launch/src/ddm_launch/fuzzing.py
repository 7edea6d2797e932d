# Fuzzing: every target several at a time, what they found as DIR/fuzzing.csv.
# SPDX-License-Identifier: BSD-3-Clause
import argparse
import concurrent.futures
import glob
import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

from tqdm import tqdm

from ddm_launch.interruption import Interrupted, raised_as_exception
from ddm_launch.run_folder import RunFolderError, read_csv
from ddm_launch.step_runner import Failure
from ddm_model.plain_file import write_file

CHECKOUT = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", ".."))
COLUMNS = ["target", "runs", "seconds", "corpus_files", "findings"]
# No input of a few kB is worth more memory than this: what takes more did not look before.
LIMITS = ["-malloc_limit_mb=64", "-rss_limit_mb=2048", "-timeout=30"]

ABOUT = """\
Feeds bytes that nobody would write to everything that reads bytes from outside: files, messages, parameters. Each
target is a program of libFuzzer with the address and undefined behaviour sanitizers, in the folder fuzz/ of the
package whose door it knocks at. It also checks what must hold for what is accepted, and that a refusal says why."""

EPILOG = """\
DIR/fuzzing.csv    a row a target: runs since its last finding, seconds, files in its corpus, findings of this call
DIR/findings/      the inputs that were found, by target. Again: PROGRAMS/PACKAGE/fuzz_TARGET FILE
DIR/corpus/        what was learned, from which the next call goes on; its runs are added to the table
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


class Outcome:
    def __init__(self, target, runs, seconds, corpus_files, findings, log):
        self.target, self.runs, self.seconds = target, runs, seconds
        self.corpus_files, self.findings, self.log = corpus_files, findings, log


def find_targets(programs, only):
    targets = [Target(path) for path in sorted(glob.glob(os.path.join(programs, "ddm_*", "fuzz_*")))]
    if not targets:
        raise Failure("there is no fuzz target in %s. Remedy: bash %s, which builds them" % (
            programs, os.path.join(CHECKOUT, "ddm_launch", "scripts", "fuzz.sh")))
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

    def progress(self, target):
        """Runs so far, as its log tells."""
        try:
            with open(self.log(target), errors="replace") as stream:
                text = stream.read()
        except OSError:
            return 0
        counts = re.findall(r"^#(\d+)\s|^stat::number_of_executed_units: +(\d+)", text, re.MULTILINE)
        return max([int(a or b) for a, b in counts], default=0)

    def run(self, target):
        """Returns its Outcome. Raises Failure if it cannot be run."""
        corpus, start = os.path.join(self.out, "corpus", target.name), time.monotonic()
        os.makedirs(corpus, exist_ok=True)
        findings = os.path.join(self.out, "findings", target.name + "-")
        before = set(glob.glob(glob.escape(findings) + "*"))
        command = [target.program, "-runs=%d" % self.runs, "-seed=%d" % self.seed, "-artifact_prefix=" + findings,
                   "-max_len=%d" % target.max_bytes(), "-print_final_stats=1"] + LIMITS + [corpus, target.seeds]
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
        return Outcome(target, self.progress(target), time.monotonic() - start, len(os.listdir(corpus)), found,
                       self.log(target))

    def stop(self):
        self.stopped = True
        for process in list(self.processes.values()):
            process.terminate()


def run_all(bench, targets, jobs, keep):
    """Outcomes in the order of the targets, each given to keep() when it is there, with a bar that counts runs."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool, tqdm(
            total=len(targets) * bench.runs, unit="run", unit_scale=True, dynamic_ncols=True, disable=None) as bar:
        futures = {target.name: pool.submit(bench.run, target) for target in targets}
        try:
            waiting = set(futures.values())
            while waiting:
                done, waiting = concurrent.futures.wait(waiting, timeout=1.0,
                                                        return_when=concurrent.futures.FIRST_COMPLETED)
                for future in done:
                    keep(future.result())
                running = [target.name for target in targets
                           if futures[target.name].running() and not futures[target.name].done()]
                bar.set_description(", ".join(running) or "done")
                bar.n = sum(bench.runs if futures[target.name].done() else min(bench.runs, bench.progress(target))
                            for target in targets if not futures[target.name].cancelled())
                bar.refresh()
            return [futures[target.name].result() for target in targets]
        except BaseException:
            for future in futures.values():
                future.cancel()
            bench.stop()
            raise


def read_table(path):
    """{target: row}, empty if there is no table yet."""
    return {row["target"]: row for row in read_csv(path, COLUMNS)} if os.path.exists(path) else {}


def add_to_table(path, outcome):
    """Runs and seconds of earlier calls count, unless something was found, then or now."""
    rows = read_table(path)
    before = rows.get(outcome.target.name, {"runs": "0", "seconds": "0", "findings": "0"})
    goes_on = before["findings"] == "0" and not outcome.findings
    rows[outcome.target.name] = {
        "target": outcome.target.name, "runs": (int(before["runs"]) if goes_on else 0) +
        (0 if outcome.findings else outcome.runs),
        "seconds": "%.0f" % ((float(before["seconds"]) if goes_on else 0.0) + outcome.seconds),
        "corpus_files": outcome.corpus_files, "findings": len(outcome.findings)}
    lines = [",".join(str(rows[name][column]) for column in COLUMNS) for name in sorted(rows)]
    write_file(path, "\n".join([",".join(COLUMNS)] + lines) + "\n")


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
    rows = [COLUMNS] + [[row[column] for column in COLUMNS] for row in read_table(table).values()]
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    for row in rows:
        print("  ".join([row[0].ljust(widths[0])] + [cell.rjust(width) for cell, width in zip(row[1:], widths[1:])]))
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
    parser.add_argument("--junit", metavar="FILE", help="verdicts as a result file of tests, too")
    arguments = parser.parse_args(arguments)
    for name in ("runs", "jobs"):
        if getattr(arguments, name) < 1:
            parser.error("--%s must be >= 1, got %d" % (name, getattr(arguments, name)))
    try:
        with raised_as_exception():
            return run(arguments)
    except Interrupted as error:
        print("fuzz: %s" % error, file=sys.stderr)
        return 128 + error.number
    except (Failure, RunFolderError, OSError) as error:
        print("fuzz: %s" % error, file=sys.stderr)
        return 1
