#!/usr/bin/python3
# The table of fuzzing: runs add up until something is found, and what is found is kept, named and an error.
# SPDX-License-Identifier: BSD-3-Clause
import contextlib
import io
import os
import sys
import xml.etree.ElementTree as ElementTree

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402, F401
from ddm_qa import fuzzing  # noqa: E402
from processes import call_main  # noqa: E402
from scratch_case import ScratchCase  # noqa: E402

# Stands in for a program of libFuzzer: reads its options, says how many runs it did, and crashes if told to.
PROGRAM = """#!/usr/bin/python3
import os, sys
options = dict(word[1:].split("=", 1) for word in sys.argv[1:] if word.startswith("-"))
corpus, seeds = [word for word in sys.argv[1:] if not word.startswith("-")]
open(os.path.join(corpus, "learned"), "w").close()
assert os.listdir(seeds)
assert os.environ["LD_LIBRARY_PATH"].split(":")[0] == os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
print("#2 INITED cov: 1")
if os.path.exists(%(crash)r):
    print("broken promise: torques are finite")
    open(options["artifact_prefix"] + "crash-0123", "w").write("input")
    sys.exit(77)
print("stat::number_of_executed_units: " + options["runs"])
sys.exit(%(code)d)
"""


class FuzzingTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.crash = self.file("crash")
        self.add("node_params")
        self.add("config_file")

    def add(self, name, code=0):
        crash = self.crash if name == "config_file" else "/no/such/file"
        path = self.write("lib/ddm_msgs/fuzz_" + name, PROGRAM % {"crash": crash, "code": code})
        os.chmod(path, 0o755)

    def call(self, *arguments):
        """Returns (exit code, output) of fuzzing."""
        return call_main(fuzzing.main, ["--programs", self.file("lib"), "--out", self.out] + list(arguments))

    def rows(self):
        """{target: (runs, corpus files, findings)}."""
        with open(os.path.join(self.out, "fuzzing.csv")) as stream:
            lines = stream.read().splitlines()
        self.assertEqual(lines[0], "target,runs,seconds,corpus_files,findings")
        cells = [line.split(",") for line in lines[1:]]
        return {row[0]: (int(row[1]), int(row[3]), int(row[4])) for row in cells}

    def test_runs_of_several_calls_add_up(self):
        self.assertEqual(self.call("--runs", "50")[0], 0)
        self.assertEqual(self.rows(), {"config_file": (50, 1, 0), "node_params": (50, 1, 0)})
        code, output = self.call("--runs", "7", "--only", "node_params")
        self.assertEqual(code, 0)
        self.assertEqual(self.rows(), {"config_file": (50, 1, 0), "node_params": (57, 1, 0)})
        self.assertIn("7 runs, 0 findings", output)

    def test_a_finding_is_kept_named_and_begins_the_count_anew(self):
        self.call("--runs", "50")
        open(self.crash, "w").close()
        code, output = self.call("--runs", "50", "--junit", self.file("results", "fuzz.xml"))
        self.assertEqual(code, 1)
        self.assertIn("FOUND by config_file: " + os.path.join(self.out, "findings", "config_file-crash-0123"), output)
        self.assertIn("broken promise: torques are finite", output)
        self.assertEqual(self.rows(), {"config_file": (0, 1, 1), "node_params": (100, 1, 0)})
        results = ElementTree.parse(self.file("results", "fuzz.xml"))
        cases = {case.get("name"): case for case in results.iter("testcase")}
        self.assertIn("torques are finite", cases["config_file"].find("failure").text)
        self.assertIsNone(cases["node_params"].find("failure"))
        os.remove(self.crash)
        self.assertEqual(self.call("--runs", "50")[0], 0)
        self.assertEqual(self.rows()["config_file"], (50, 1, 0))

    def test_a_program_that_fails_without_an_input_is_an_error(self):
        self.add("image_message", code=3)
        code, output = self.call("--runs", "5")
        self.assertEqual(code, 1)
        self.assertIn("image_message", output)

    def test_mistakes_are_told_with_what_there_is(self):
        code, output = self.call("--only", "model")
        self.assertEqual(code, 1)
        self.assertIn("config_file, node_params", output)
        self.add("nobody_planted")
        self.assertIn("nobody_planted", self.call()[1])
        with contextlib.redirect_stderr(io.StringIO()) as told:
            self.assertEqual(fuzzing.main(["--programs", self.file("nowhere"), "--out", self.out]), 1)
        self.assertIn(self.file("nowhere"), told.getvalue())
        self.assertIn("fuzz.sh", told.getvalue())


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "fuzzing_test", FuzzingTest)
