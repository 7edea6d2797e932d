#!/usr/bin/python3
# growth: its table, figure and exponent from made-up rows, and what it says of a trainer that learned too little.
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
from unittest import mock

import rosunit

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rooms  # noqa: E402, F401
from ddm_launch.command import Failure  # noqa: E402
from ddm_qa import growth  # noqa: E402
from ddm_qa.processes import Programs  # noqa: E402
import figure_case  # noqa: E402
from run_files import read_bytes, read_rows, read_yaml  # noqa: E402


class GrowthTest(figure_case.FigureCase):
    def leave(self, programs, what, command, **_):
        """speed_growth: the objective takes a microsecond a frame. The launch file leaves its peak."""
        if what == "growth":
            frames, size = (int(command[command.index(option) + 1]) for option in ("--frames", "--size"))
            return "%d,%d,%d,%d,90\n" % (frames, size, 10 * frames, frames)
        if what == "retrain":
            return "v_p: 3\ntrain_s: 6.5\npeak_memory_mb: 150.4\n"
        for word in command:
            if word.startswith("out:="):
                with open(word.split(":=")[1], "w") as stream:
                    stream.write("{frames: %d, peak_memory_mb: 640.04}\n" % self.frames_learned)
        return ""

    def make(self, frames_learned=100000):
        self.frames_learned = frames_learned
        with mock.patch.object(Programs, "call", lambda *words, **more: self.leave(*words, **more)), \
                mock.patch.object(Programs, "roslaunch", lambda programs, what, *words: self.leave(programs, what, words)), \
                mock.patch.object(growth, "find_program", lambda name, package=None: name):
            return growth.make(self.scratch)

    def test_table_figure_and_exponent_come_from_the_rows(self):
        found = self.make()
        self.assertEqual((found["exponent"], found["model_node_peak_memory_mb"]), (1.0, 640.0))
        rows = read_rows(self.scratch, "growth.csv")
        self.assertEqual(",".join(rows[0]), growth.COLUMNS)
        self.assertEqual([row[:2] for row in rows[1:]],
                         [[str(frames), "51"] for frames in (1000, 3000, 10000, 30000, 100000)] +
                         [["1600", str(size)] for size in (51, 71, 101, 142, 201)])
        self.assertEqual(read_rows(self.scratch, "retrain.csv"), [["frames", "train_s", "peak_memory_mb"]] + [
            [str(frames), "6.5", "150.4"] for frames in (1000, 3000, 10000, 20000)])
        self.assertEqual(read_bytes(self.scratch, "growth.png")[:4], b"\x89PNG")
        self.assertEqual(read_yaml(self.scratch, "growth.yaml")["exponent"], 1.0)

    def test_the_exponent_is_the_slope_of_logarithms(self):
        self.assertAlmostEqual(growth.exponent([1.0, 2.0, 4.0, 8.0], [3.0, 12.0, 48.0, 192.0]), 2.0)

    def test_a_trainer_that_learned_from_less_is_told(self):
        with self.assertRaisesRegex(Failure, "100000.*7"):
            self.make(frames_learned=7)


if __name__ == "__main__":
    rosunit.unitrun("ddm_launch", "growth", GrowthTest)
