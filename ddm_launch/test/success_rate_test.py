# Success rates against the paper's: the numbers of each curve, the published data, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_launch import success_rate
from ddm_launch.command import Failure
from ddm_launch.figure_style import COLUMN_WIDTH, new_figure
import figure_case

PUBLISHED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "results", "published", "success_rate.csv")
HEADER = "seed,trial,frames,success,final_error"


class SuccessRateTest(figure_case.FigureCase):
    def writeSweep(self, name="sweep.csv"):
        return self.writeLines(name, HEADER, "0,0,100,0,90", "0,1,200,1,2", "1,0,100,1,3", "1,1,200,1,1",
                               "2,0,100,0,50", "3,0,100,1,4")

    def test_a_curve_is_the_rate_over_all_seeds_of_a_file(self):
        curve = success_rate.read_curve("mine", self.writeSweep())
        self.assertEqual(curve.label, "mine (4 seeds)")
        self.assertEqual((curve.frames, curve.rates), ([100, 200], [0.5, 1.0]))
        self.assertAlmostEqual(curve.errors[0], (0.25 / 3.0) ** 0.5)

    def test_wilsons_intervals_are_a_band_in_the_place_of_error_bars(self):
        curve = success_rate.read_curve("mine", self.writeSweep(), wilson=True)
        self.assertIsNone(curve.errors)
        self.assertAlmostEqual(curve.band[0][0] + curve.band[1][0], 1.0)  # of 2 of 4 seeds
        self.assertAlmostEqual(curve.band[0][1], 1.0 / (1.0 + 1.959964 ** 2 / 2.0), places=6)  # of 2 of 2
        self.assertEqual(curve.band[1][1], 1.0)
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = figure.add_subplot(1, 1, 1)
            success_rate.draw_curves(axes, [curve], [])
            corners = axes.collections[-1].get_paths()[0].vertices
            self.assertEqual((min(corners[:, 0]), max(corners[:, 0])), (100, 200))
            self.assertAlmostEqual(min(corners[:, 1]), curve.band[0][0])
            self.assertEqual(axes.containers[0].lines[2], ())  # no error bars
        self.assertDrawn(success_rate, ["mine=" + self.writeSweep(), "--published", PUBLISHED, "--wilson"],
                         COLUMN_WIDTH)

    def test_the_published_curve_is_the_papers(self):
        curves = success_rate.read_published(PUBLISHED)
        paper = curves[0]
        self.assertEqual(paper.label, "DDM + MPC (paper)")
        self.assertEqual(paper.frames, [100.0 * k for k in range(16)])
        self.assertEqual(paper.rates[1:4] + paper.rates[-1:], [0.08, 0.22, 0.5, 0.86])
        for rate, error in zip(paper.rates, paper.errors):  # 50 seeds
            self.assertAlmostEqual(error, (rate * (1.0 - rate) / 49.0) ** 0.5, places=5)
        self.assertEqual([curve.rates[1] for curve in curves[1:]], [0.91, 0.0, 0.0])

    def test_all_curves_are_drawn_with_their_error_bars(self):
        ours = [success_rate.read_curve("mine", self.writeSweep())]
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = figure.add_subplot(1, 1, 1)
            success_rate.draw_curves(axes, ours, success_rate.read_published(PUBLISHED))
            labels = axes.get_legend_handles_labels()[1]
            points = figure_case.drawn_points(axes, "mine (4 seeds)")
            bars = [container.lines[2][0].get_segments()[0] for container in axes.containers
                    if container.get_label() == "mine (4 seeds)"][0]
            axis_labels = (axes.get_xlabel(), axes.get_ylabel())
        self.assertEqual(labels, ["mine (4 seeds)"] + [row[0] + " (paper)" for row in success_rate.METHODS])
        self.assertEqual(points, [(100, 0.5), (200, 1.0)])
        self.assertAlmostEqual(bars[1][1] - bars[0][1], 2.0 * (0.25 / 3.0) ** 0.5)
        self.assertEqual(axis_labels, ("frames learned from [image-torque pairs]", "success rate [-]"))

    def test_a_method_that_learns_from_no_frames_is_a_level_line_to_the_end(self):
        oracle = success_rate.read_curve("oracle", self.writeLines("oracle.csv", HEADER, "0,0,0,1,1", "1,0,0,0,50"))
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = figure.add_subplot(1, 1, 1)
            success_rate.draw_curves(axes, [oracle], success_rate.read_published(PUBLISHED))
            self.assertEqual(figure_case.drawn_points(axes, "oracle (2 seeds)"), [(0, 0.5), (1500, 0.5)])
        band = success_rate.read_curve("oracle", self.file("oracle.csv"), wilson=True)
        self.assertEqual([len(edge) for edge in band.spread_to(1500).band], [2, 2])

    def test_of_many_curves_those_that_are_mostly_zero_are_named_and_not_drawn(self):
        rows = ["%d,%d,%d,%d,1" % (seed, trial, 100 * (trial + 1), seed == trial == 4) for seed in range(5) for trial in range(5)]
        path = self.writeLines("zero.csv", HEADER, *rows)
        for names, drawn in ((["low"], [(100, 0.0), (200, 0.0), (300, 0.0), (400, 0.0), (500, 0.2)]), (["low", "mine"], [])):
            curves = [success_rate.read_curve(name, path if name == "low" else self.writeSweep()) for name in names]
            with new_figure(COLUMN_WIDTH, 3.0) as figure:
                axes = figure.add_subplot(1, 1, 1)
                success_rate.draw_curves(axes, curves, success_rate.read_published(PUBLISHED))
                labels = axes.get_legend_handles_labels()[1]
                found = [figure_case.drawn_points(axes, label) for label in labels if label.startswith("low")]
            self.assertEqual(found, [drawn], labels)
            self.assertEqual([label for label in labels if ": " in label],
                             [] if drawn else ["low (5 seeds): mostly 0, at most 0.2", "PILCO, features (paper): 0",
                                               "PILCO, PCA (paper): 0"])

    def test_a_slow_learner_is_drawn(self):
        for last, is_mostly_zero in ((0.4, True), (0.5, False)):
            self.assertEqual(success_rate.Curve("slow", "1 seed", [1, 2, 3], [0.0, 0.0, last], None).is_mostly_zero(),
                             is_mostly_zero)

    def test_a_name_that_is_there_twice_is_refused(self):
        curve = "DDM + MPC=" + self.writeSweep()
        self.assertRefused(success_rate, [curve, curve], "DDM + MPC")

    def test_several_files_and_the_paper_make_a_picture_as_wide_as_a_column(self):
        path = self.writeSweep()
        self.assertDrawn(success_rate, ["joint=" + path, "oracle=" + path, "--published", PUBLISHED],
                         COLUMN_WIDTH)

    def test_a_curve_without_label_or_file_is_refused(self):
        for word in ("sweep.csv", "=sweep.csv", "mine="):
            code, output = self.callMain(success_rate, word)
            self.assertEqual(code, 2)
            self.assertIn("must be LABEL=FILE.csv, got '%s'" % word, output)

    def test_more_curves_than_can_be_told_apart_are_refused(self):
        curves = ["%d=%s" % (k, self.writeSweep()) for k in range(5)] + ["DDM + MPC=" + self.writeSweep()]
        self.assertRefused(success_rate, curves, "at most 4 curves", "PILCO, state", "got 5")

    def test_a_seed_that_is_there_twice_is_refused(self):
        path = self.writeLines("twice.csv", HEADER, "7,0,100,0,90", "7,0,100,1,2")
        self.assertRefused(success_rate, ["mine=" + path], path, "seed 7, trial 0")

    def test_runs_of_unknown_success_are_refused(self):
        path = self.writeLines("unknown.csv", HEADER, "7,0,100,,")
        with self.assertRaisesRegex(Failure, path):
            success_rate.read_curve("mine", path)

    def test_files_that_are_missing_are_named(self):
        self.assertRefused(success_rate, ["mine=missing.csv"], "missing.csv", "sweep.csv")
        self.assertRefused(success_rate, ["mine=" + self.writeSweep(), "--published", "no.csv"], "no.csv",
                           "results/published/success_rate.csv")
