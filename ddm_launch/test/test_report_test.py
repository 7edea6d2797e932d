#!/usr/bin/python3
# The count of test cases that test.sh closes with, against result files as the test runners write them.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import importlib.util
import io
import json
import os
import re
import subprocess
import sys

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from scratch_case import ScratchCase  # noqa: E402

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "qa", "test_report.py")
spec = importlib.util.spec_from_file_location("test_report", SCRIPT)
test_report = importlib.util.module_from_spec(spec)
spec.loader.exec_module(test_report)

PASS = '<testcase classname="Mlp" name="%s" status="run"/>'
FAIL = ('<testcase classname="Mlp" name="%s" status="run">'
        '<failure message="m">expected 1 &amp; got 2</failure></testcase>')
SKIP = '<testcase classname="Mlp" name="%s" status="run"><skipped message="no camera"/></testcase>'
SKIP_OF_OLD_GTEST = '<testcase classname="Mlp" name="%s" status="run" result="skipped"/>'
WRAPPER = '<testcase classname="rostest.runner.RosTest" name="test%s"/>'

PYTHON_TEST = """
import sys, unittest, rosunit
sys.path.insert(0, "%s")
import skips
class Part(unittest.TestCase):
    def test_c(self): self.skipTest("no camera")
    def test_d(self): pass
@unittest.skip("no camera")
class Whole(unittest.TestCase):
    def test_a(self): pass
    def test_b(self): pass
rosunit.unitrun("ddm_model", "a_test", {"part": Part, "whole": Whole}[sys.argv[1]])
"""


def command(result):
    """As catkin declares it: the file, then a program that writes it."""
    return ["env.sh", "run_tests.py", result, "--return-code", "program --gtest_output=xml:" + result]


class TestReportTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.declared = {}

    def declare(self, file_name, end="passed", build="build"):
        """A test that ctest ran, and how it ended ("passed" or "failed")."""
        self.declared.setdefault(build, []).append((file_name, end))

    def writeCases(self, file_name, cases, failures=0, build="build"):
        self.write(os.path.join(build, "test_results", "ddm_model", file_name),
                   '<testsuite failures="%d" errors="0">%s</testsuite>' % (failures, "".join(cases)))

    def writeRun(self, build, tests):
        """What ctest leaves of tests: (name, "passed" or "failed", seconds)."""
        self.write(os.path.join(build, "Testing", "TAG"), "20260101-0000\nExperimental\n")
        value = '<NamedMeasurement name="%s"><Value>%s</Value></NamedMeasurement>'
        self.write(os.path.join(build, "Testing", "20260101-0000", "Test.xml"), "<Site><Testing>%s</Testing></Site>" % "".join(
            '<Test Status="%s"><Name>%s</Name><Results>%s</Results></Test>' % (
                end, name, value % ("Execution Time", seconds) + (value % ("Exit Code", "Timeout") if end == "failed" else ""))
            for name, end, seconds in tests))

    def report(self):
        """Returns (exit code, lines printed but for the slowest tests)."""
        builds = []
        for build, tests in self.declared.items():
            folder = self.file(build)
            os.makedirs(folder, exist_ok=True)
            builds.append(folder)
            names = ["_ctest_" + file_name for file_name, _ in tests]
            with open(os.path.join(folder, "tests_declared.json"), "w") as stream:
                results = os.path.join(folder, "test_results", "ddm_model")
                json.dump({"tests": [{"name": name, "command": command(os.path.join(results, file_name))}
                                     for name, (file_name, _) in zip(names, tests)]}, stream)
            self.writeRun(build, [(name, end, 0.0) for name, (_, end) in zip(names, tests)])
        with contextlib.redirect_stdout(io.StringIO()) as output:
            code = test_report.main(builds)
        return code, [line for line in output.getvalue().splitlines() if not re.match("slowest tests:| +[0-9]+ s ", line)]

    def test_all_passed_returns_0_and_closes_with_the_count(self):
        self.declare("gtest-a.xml")
        self.writeCases("gtest-a.xml", [PASS % "One", PASS % "Two"])
        self.assertEqual(self.report(), (0, ["2 passed, 0 failed"]))

    def test_the_slowest_tests_are_listed_first(self):
        self.writeRun("build", [("test_%02d" % number, "passed", number + 0.25) for number in range(12)])
        lines = test_report.slowest_tests([self.file("build")])
        self.assertEqual(len(lines), 1 + 10)
        self.assertEqual(lines[1].split()[:3], ["11", "s", "test_11"])
        self.assertEqual(lines[-1].split()[2], "test_02")

    def test_a_failure_is_named_with_its_message(self):
        self.declare("gtest-a.xml", "failed")
        self.writeCases("gtest-a.xml", [PASS % "One", FAIL % "Two"], failures=1)
        code, lines = self.report()
        self.assertEqual((code, lines[-1]), (1, "1 passed, 1 failed"))
        self.assertIn("Mlp.Two", lines[0])
        self.assertIn("expected 1 & got 2", lines[1])

    def test_a_report_of_a_sanitizer_fails_the_build_and_none_is_a_case_that_passed(self):
        self.declare("gtest-a.xml")
        self.writeCases("gtest-a.xml", [PASS % "One"])
        reports = self.file("build", "sanitizer_reports")
        os.mkdir(reports)
        self.assertEqual(self.report(), (0, ["2 passed, 0 failed"]))
        self.write("build/sanitizer_reports/report.17", "==17==ERROR: AddressSanitizer: heap-use-after-free")
        code, lines = self.report()
        self.assertEqual((code, lines[-1]), (1, "1 passed, 1 failed"))
        self.assertIn("sanitizer_reports", lines[0])
        self.assertIn("report.17", lines[1])
        self.assertIn("heap-use-after-free", lines[2])

    def test_a_case_of_two_builds_counts_once_and_must_pass_in_both(self):
        for build, second in (("build", PASS), ("debug", FAIL)):
            self.declare("gtest-a.xml", "passed" if second == PASS else "failed", build)
            self.writeCases("gtest-a.xml", [PASS % "One", second % "Two"], failures=int(second == FAIL), build=build)
        self.assertEqual(self.report()[1][-1], "1 passed, 1 failed")

    def test_the_runner_of_a_rostest_is_no_case_of_its_own(self):
        self.declare("rostest-loop.xml")
        self.writeCases("rostest-loop.xml", [WRAPPER % "loop"])
        self.writeCases("rosunit-loop.xml", [PASS % "One"])
        self.assertEqual(self.report(), (0, ["1 passed, 0 failed"]))

    def test_a_failing_rostest_counts_only_its_failing_cases(self):
        self.declare("rostest-loop.xml", "failed")
        self.writeCases("rostest-loop.xml", [WRAPPER % "loop"])
        self.writeCases("rosunit-loop.xml", [PASS % "One", FAIL % "Two"], failures=1)
        self.assertEqual(self.report()[1][-1], "1 passed, 1 failed")

    def test_a_program_that_leaves_no_result_fails(self):
        self.declare("gtest-a.xml")
        self.declare("gtest-crash.xml", "failed")
        self.writeCases("gtest-a.xml", [PASS % "One"])
        self.writeCases("MISSING-gtest-crash.xml", [FAIL % "test_ran"], failures=1)
        code, lines = self.report()
        self.assertEqual((code, lines[-1]), (1, "1 passed, 1 failed"))
        self.assertIn("gtest-crash.xml", lines[0])

    def test_a_program_that_fails_after_its_cases_passed_fails(self):
        self.declare("gtest-a.xml", "failed")
        self.writeCases("gtest-a.xml", [PASS % "One"])
        code, lines = self.report()
        self.assertEqual((code, lines[-1]), (1, "1 passed, 1 failed"))
        self.assertIn("no case", lines[1])

    def test_failures_that_only_the_sum_knows_fail(self):
        self.declare("rosunit-a.xml", "failed")
        self.writeCases("rosunit-a.xml", [PASS % "One"], failures=3)
        self.assertEqual(self.report()[1][-1], "1 passed, 1 failed")

    def test_a_file_without_cases_fails(self):
        self.declare("gtest-a.xml")
        self.writeCases("gtest-a.xml", [])
        self.assertEqual(self.report()[1][-1], "0 passed, 1 failed")

    def test_a_file_that_is_cut_short_fails(self):
        self.declare("gtest-a.xml")
        self.writeCases("gtest-a.xml", ["<testcase"])
        self.assertEqual(self.report()[1][-1], "0 passed, 1 failed")

    def test_skipped_cases_are_named_with_the_reason_and_count_neither_way(self):
        self.declare("gtest-a.xml")
        self.writeCases("gtest-a.xml", [PASS % "One", SKIP % "Two", SKIP_OF_OLD_GTEST % "Three"])
        code, lines = self.report()
        self.assertEqual((code, lines[-2:]), (0, ["2 skipped", "1 passed, 0 failed"]))
        self.assertIn("Mlp.Three", lines[0])
        self.assertRegex(lines[1], r"Mlp\.Two.*no camera")

    def test_skipped_cases_of_python_are_named_with_the_reason(self):
        program = self.write("a_test.py", PYTHON_TEST % os.path.dirname(os.path.abspath(__file__)))
        for name in ("part", "whole"):
            result = name + ".xml"
            self.declare(result)
            self.writeCases(result, [])  # makes the folder
            subprocess.run(["/usr/bin/python3", program, name, "--gtest_output=xml:%s" %
                            self.file("build", "test_results", "ddm_model", result)], check=True, stdout=subprocess.DEVNULL)
        code, lines = self.report()
        self.assertEqual((code, lines[-2:]), (0, ["3 skipped", "1 passed, 0 failed"]), lines)
        for name in ("Whole.test_a", "Whole.test_b", "Part.test_c"):
            self.assertEqual(len([line for line in lines if name in line and "no camera" in line]), 1, lines)

    def test_a_build_that_declares_no_test_fails(self):
        self.declared["build"] = []
        self.assertEqual(self.report()[0], 1)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "test_report_test", TestReportTest)
