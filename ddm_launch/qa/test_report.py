#!/usr/bin/python3
# Counts test cases in the result files of one or more catkin build folders; each case counts once.
# SPDX-License-Identifier: BSD-3-Clause
"""usage: test_report.py BUILD_FOLDER [BUILD_FOLDER ...]

Each folder contains test_results/PACKAGE/*.xml (JUnit) and the results of ctest -T Test in Testing/. A build with
sanitizers also has sanitizer_reports/, where each file counts as a failure. Prints the ten slowest tests, each failure
and each skipped case, then "N passed, N failed". Returns 1 if any case failed. A case that ran in several builds (same
package, result file and name) counts once and must pass in all of them.
"""
import collections
import glob
import os
import re
import sys
import xml.etree.ElementTree as ElementTree

# rostest writes a case of this class for each program that it starts, and the program writes its own cases into a
# second file. Hence the case of this class adds information only if it failed.
ROSTEST_WRAPPER = "rostest.runner.RosTest"

# Cases are (package, result file, name). skipped: {case: reason}.
passed, skipped = set(), {}
failures = collections.defaultdict(list)  # {case: messages}
times = []  # (seconds, test, build)


def read_results(path, build):
    """Adds the cases of one JUnit file. Returns whether one of them failed."""
    package, name = os.path.basename(os.path.dirname(path)), os.path.basename(path)
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        failures[package, name, "the result file"].append("[%s] cannot be read: %s" % (build, error))
        return True
    any_failed = False
    for element in root.iter("testcase"):
        case = (package, name, "%s.%s" % (element.get("classname"), element.get("name")))
        problems, skip = element.findall("failure") + element.findall("error"), element.find("skipped")
        failures[case] += ["[%s] %s" % (build, problem.text or problem.get("message")) for problem in problems]
        any_failed = any_failed or bool(problems)
        if skip is not None or element.get("result") == "skipped" or element.get("status") == "notrun":
            # Older versions of gtest write no reason.
            reason = (skip.get("message") if skip is not None else None) or "see its log"
            skipped[case] = " ".join(reason.split())
        elif element.get("classname") != ROSTEST_WRAPPER:
            passed.add(case)
    return any_failed


def read_build(folder):
    """Adds all results of one build folder. Also adds a failure for each test that failed without a failed case,
    because it crashed, hung or left no results."""
    with open(os.path.join(folder, "CMakeCache.txt")) as stream:
        build = re.search(r"^CMAKE_BUILD_TYPE:\w+=(\w+)$", stream.read(), re.MULTILINE).group(1)
    told = set()
    for path in sorted(glob.glob(os.path.join(folder, "test_results", "*", "*.xml"))):
        if read_results(path, build):
            package, name = path[:-len(".xml")].replace("MISSING-", "").split(os.sep)[-2:]
            told.add("_ctest_%s_%s" % (package, name.replace("-", "_", 1)))
    for path in sorted(glob.glob(os.path.join(folder, "sanitizer_reports", "*"))):
        with open(path, errors="replace") as stream:
            failures[build, "sanitizer_reports", os.path.basename(path)].append(stream.read())
    # test.sh removes the results of earlier calls.
    results = glob.glob(os.path.join(folder, "Testing", "2*", "Test.xml"))
    tests = ElementTree.parse(results[-1]).findall("Testing/Test") if results else []
    if not tests:
        failures[build, "ctest", "the tests"].append("no test has run")
    for test in tests:
        measured = {value.get("name"): value.findtext("Value") for value in test.iter("NamedMeasurement")}
        name = test.findtext("Name")
        times.append((float(measured.get("Execution Time", 0)), name, build))
        if test.get("Status") != "passed" and name not in told:
            failures[build, "ctest", name].append("failed (%s) although no case did: see its output above" % (
                measured.get("Exit Code") or measured.get("Completion Status")))


def main(folders):
    for folder in folders:
        read_build(os.path.abspath(folder))
    print("slowest tests:")
    for test in sorted(times, reverse=True)[:10]:
        print("%6.0f s  %s [%s]" % test)
    failed = {case: messages for case, messages in failures.items() if messages}
    for (package, name, case), messages in sorted(failed.items()):
        print("FAILED  %s: %s (%s)" % (package, case, name))
        for line in [line for message in messages for line in message.strip().splitlines()[:40]]:
            print("        " + line)
    not_run = sorted(set(skipped) - passed)
    for case in not_run:
        print("skipped %s: %s (%s): %s" % (case[0], case[2], case[1], skipped[case]))
    if not_run:
        print("%d skipped" % len(not_run))
    print("%d passed, %d failed" % (len(passed - set(failed)), len(failed)))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
