# What rviz shows of an experiment: pictures of the real one by `qa rviz_screenshot`, on a screen in memory.
# SPDX-License-Identifier: BSD-3-Clause
import os
import tempfile
import unittest

import numpy as np
from PIL import Image

from ddm_qa.rviz_screenshot import DISPLAYS, HEIGHT, WIDTH, blank_displays

from processes import call, find_program


class RvizTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as scratch:
            out = os.path.join(scratch, "rviz.png")
            cls.code, cls.output = call(
                [find_program("qa"), "rviz_screenshot", "--out", out, "--after-trial", 1, "--seconds", 0, "--",
                 "preset:=debug", "trials:=999", "seed:=1"], limit_s=200.0)
            cls.pixels = np.array(Image.open(out).convert("RGB")) if cls.code == 0 else None

    def test_each_display_shows_what_it_should(self):
        self.assertEqual(self.code, 0, self.output)
        self.assertEqual(self.pixels.shape, (HEIGHT, WIDTH, 3))
        self.assertEqual(blank_displays(self.pixels), [])

    def test_a_display_of_one_colour_is_noticed(self):
        self.assertEqual(self.code, 0, self.output)
        for name, (left, top, right, bottom) in DISPLAYS.items():
            for spoilt in (0, 48, 255):
                pixels = self.pixels.copy()
                pixels[top:bottom, left:right] = spoilt
                self.assertEqual(blank_displays(pixels), [name])

    def test_what_the_launch_file_does_not_accept_is_told(self):
        code, output = call([find_program("qa"), "rviz_screenshot", "--out", "/nowhere/rviz.png", "--",
                             "preset:=no_such_preset"])
        self.assertEqual(code, 1)
        self.assertIn("no_such_preset", output)
        self.assertIn("ended before the end of trial 5", output)
