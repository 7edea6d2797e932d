# Tests of figure_style and averages: how figures are saved, and means with standard errors.
# SPDX-License-Identifier: BSD-3-Clause
import errno
import os

from ddm_launch import figure_style
from ddm_launch.averages import mean_and_error
from ddm_launch.command import Failure, run_program
from figure_case import FigureCase
from processes import call_main


class FigureStyleTest(FigureCase):
    def draw(self, name, height=1.0):
        path = self.file(name)
        with figure_style.new_figure(2.0, height) as figure:
            figure.add_subplot(1, 1, 1).plot([0, 1], [0, height])
            figure_style.save(figure, path)
        with open(path, "rb") as stream:
            return stream.read()

    def test_the_same_figure_gives_the_same_bytes_and_another_one_others(self):
        self.assertEqual(self.draw("a.png"), self.draw("b.png"))
        self.assertNotEqual(self.draw("a.png"), self.draw("b.png", height=1.5))

    def test_a_picture_that_is_no_png_is_refused(self):
        with self.assertRaisesRegex(Failure, r"\.png.*a\.pdf"):
            self.draw("a.pdf")

    def test_a_folder_that_does_not_exist_ends_with_code_1_and_its_name(self):
        self.out = self.file("missing", "a.png")
        code, output = call_main(lambda: run_program("program", lambda: self.draw(self.out)))
        self.assertEqual(code, 1)
        self.assertTrue(output.startswith("program: "), output)
        self.assertIn(self.out, output)

    def test_a_picture_that_cannot_be_completed_is_named_and_the_former_one_stays(self):
        before = self.draw("a.png")
        self.limitFiles(len(before) - 1)
        with self.assertRaises(OSError) as caught:
            self.draw("a.png", height=1.5)
        for part in (self.file("a.png"), os.strerror(errno.EFBIG)):
            self.assertIn(part, str(caught.exception))
        self.assertEqual(os.listdir(self.scratch), ["a.png"])
        with open(self.file("a.png"), "rb") as stream:
            self.assertEqual(stream.read(), before)

    def test_a_pipe_is_not_replaced_by_a_picture_and_a_link_stays_one(self):
        os.mkfifo(self.file("pipe.png"))
        with self.assertRaisesRegex(OSError, "/pipe.png: .*regular file$"):
            self.draw("pipe.png")
        os.symlink("a.png", self.file("link.png"))
        picture = self.draw("link.png")
        self.assertTrue(os.path.islink(self.file("link.png")))
        with open(self.file("a.png"), "rb") as stream:
            self.assertEqual(stream.read(), picture)

    def test_the_standard_error_is_that_of_a_sample(self):
        mean, error = mean_and_error([1.0, 2.0, 6.0])
        self.assertAlmostEqual(mean, 3.0)
        self.assertAlmostEqual(error, (14.0 / 2.0 / 3.0) ** 0.5)
        self.assertEqual(mean_and_error([4.0]), (4.0, 0.0))
