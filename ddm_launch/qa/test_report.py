#!/usr/bin/python3
# Counts test cases from the result files of one or more catkin build folders; each case counts once.
# SPDX-License-Identifier: BSD-3-Clause
"""usage: test_report.py BUILD_FOLDER [BUILD_FOLDER ...]

Each folder holds test_results/PACKAGE/*.xml (JUnit), tests_declared.json (ctest --show-only=json-v1) and what
ctest -T Test leaves in Testing/; one with sanitizers also sanitizer_reports/, where each file is a failure.
Prints the ten slowest tests, each failure and each skipped case, then "N passed, N failed"; returns 1 if any failed.
A case that ran in several builds (same package, result file and name) counts once and must pass in all of them.
"""
import glob
import json
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

# rostest writes a case of this class for each program that it starts; the program's own cases are in a
# second file. So it says something new only if it failed.
ROSTEST_WRAPPER = "rostest.runner.RosTest"


class Report:
    """Verdicts by case: a case is (package, result file, name)."""

    def __init__(self):
        self.passed, self.skipped, self.failures = set(), {}, {}  # skipped: case -> reason; failures: case -> messages

    def fail(self, case, message):
        self.failures.setdefault(case, []).append(message.strip())

    def text(self):
        lines = []
        for case in sorted(self.failures):
            lines.append("FAILED  %s: %s (%s)" % (case[0], case[2], case[1]))
            for message in self.failures[case]:
                lines += ["        " + line for line in message.splitlines()[:40]]
        skipped = sorted(set(self.skipped) - self.passed)
        lines += ["skipped %s: %s (%s): %s" % (c[0], c[2], c[1], self.skipped[c]) for c in skipped]
        lines += ["%d skipped" % len(skipped)] if skipped else []
        return lines + ["%d passed, %d failed" % (len(self.passed - set(self.failures)), len(self.failures))]


def read_results(report, path, build):
    """Adds the cases of one JUnit file. Returns (number of failures in it, names of the programs it wraps)."""
    package, name = os.path.basename(os.path.dirname(path)), os.path.basename(path)
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        report.fail((package, name, "the result file"), "[%s] cannot be read: %s" % (build, error))
        return 1, []
    failed, wrapped = 0, []
    cases = list(root.iter("testcase"))
    for element in cases:
        case = (package, name, "%s.%s" % (element.get("classname"), element.get("name")))
        problems = element.findall("failure") + element.findall("error")
        for problem in problems:
            report.fail(case, "[%s] %s" % (build, problem.text or problem.get("message") or "no message"))
        failed += bool(problems)
        skip = element.find("skipped")
        if element.get("classname") == ROSTEST_WRAPPER:
            wrapped.append(element.get("name")[len("test"):])
        elif skip is not None or element.get("result") == "skipped" or element.get("status") == "notrun":
            reason = (skip.get("message") if skip is not None else None) or "see its log"  # older gtest gives none
            report.skipped[case] = " ".join(reason.split())
        elif not problems:
            report.passed.add(case)
    # rosunit leaves a failed subTest out of the cases, but not out of the sum
    declared = sum(int(root.get(key) or 0) for key in ("failures", "errors"))
    if declared > failed or not cases:
        report.fail((package, name, "the result file"), "[%s] %d failed of %d cases: see the log of this test" % (
            build, declared, len(cases)))
    return max(declared, failed, not cases), wrapped


def ctest_cases(build_folder):
    """(name, verdict or None if it passed, seconds) of each test that ctest ran last."""
    with open(os.path.join(build_folder, "Testing", "TAG")) as stream:
        tag = stream.readline().strip()
    cases = []
    for element in ElementTree.parse(os.path.join(build_folder, "Testing", tag, "Test.xml")).iterfind("Testing/Test"):
        measured = {value.get("name"): value.findtext("Value") for value in element.iter("NamedMeasurement")}
        end = measured.get("Exit Code") or measured.get("Completion Status")  # a program that is not there has no code
        cases.append((element.findtext("Name"), None if element.get("Status") == "passed" else end,
                      float(measured.get("Execution Time", 0))))
    return cases


def build_name(build_folder):
    """Its CMAKE_BUILD_TYPE."""
    with open(os.path.join(build_folder, "CMakeCache.txt")) as stream:
        return re.search(r"^CMAKE_BUILD_TYPE:\w+=(\w+)$", stream.read(), re.MULTILINE).group(1)


def read_build(report, build_folder):
    """Adds all results of one build folder, and a failure for each test that says nothing or too little."""
    build, results = build_name(build_folder), os.path.join(build_folder, "test_results", "*", "*.xml")
    found = {os.path.abspath(path): read_results(report, path, build) for path in sorted(glob.glob(results))
             if not os.path.basename(path).startswith("MISSING-")}  # those are told below, with the reason
    reports = os.path.join(build_folder, "sanitizer_reports")
    if os.path.isdir(reports):  # a case, which fails where a sanitizer has left a file
        report.passed.add((build, "sanitizer_reports", "no report"))
        for name in sorted(os.listdir(reports)):
            with open(os.path.join(reports, name), errors="replace") as stream:
                report.fail((build, "sanitizer_reports", "no report"), "%s:\n%s" % (name, stream.read()))
    with open(os.path.join(build_folder, "tests_declared.json")) as stream:
        tests = json.load(stream)["tests"]
    ended = {name: end for name, end, _ in ctest_cases(build_folder)}
    for test in tests:
        # later words are commands, which also end with the result file
        path = next((word for word in test.get("command", []) if word.endswith(".xml") and "/test_results/" in word), None)
        if path is None:
            continue
        folder, name = os.path.split(os.path.abspath(path))
        case, end = (os.path.basename(folder), name, "the program"), ended.get(test["name"])
        if os.path.join(folder, name) not in found:
            report.fail(case, "[%s] left no results (%s): see its output above" % (build, end or "it ended well"))
            continue
        failures, wrapped = found[os.path.join(folder, name)]
        failures += sum(found.get(os.path.join(folder, "rosunit-%s.xml" % program), (0, []))[0] for program in wrapped)
        if end and not failures:
            report.fail(case, "[%s] failed (%s) although no case did: see its output above" % (build, end))
    if not tests:
        report.fail((build, "tests_declared.json", "the build"), "declares no test")


def main(build_folders):
    report = Report()
    for folder in build_folders:
        read_build(report, os.path.abspath(folder))
    times = [(seconds, name, build_name(folder)) for folder in build_folders for name, _, seconds in ctest_cases(folder)]
    print("\n".join(["slowest tests:"] + ["%6.0f s  %s [%s]" % test for test in sorted(times, reverse=True)[:10]]
                    + report.text()))
    return 1 if report.failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
