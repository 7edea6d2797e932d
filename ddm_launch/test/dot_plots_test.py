# The ablation's figure and that of the nuisances: their dots and bars, the order of rows, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
import os

from ddm_study import ablation_compared, nuisances_compared
from ddm_study.dot_plot import draw_figure_of_dots
from ddm_launch.figure_style import COLUMN_WIDTH, new_figure
import figure_case

ABLATION = "variant,label,frames,seeds,success,success_se,difference,difference_se"
NUISANCES = "nuisance,frames,runs,success,low,high,success_strict,strict_low,strict_high"
LATER = "mean of 200 to 300 frames"


def container(axes, label):
    return [each for each in axes.containers if each.get_label() == label][0]


def bars(axes, label):
    """(left, right) of each bar."""
    return [(segment[0][0], segment[1][0]) for segment in container(axes, label).lines[2][0].get_segments()]


class DotPlotsTest(figure_case.FigureCase):
    def writeAblation(self, *rows):
        return self.writeLines("ablation.csv", ABLATION, *(rows or (
            "preset,Full preset,100,50,0.9,0.01,0,0", "preset,Full preset,100 to 300,50,0.9,0.01,0,0",
            "preset,Full preset,200 to 300,50,0.9,0.01,0,0",
            "warm_up,Without warm-up,100,50,0.9,0.01,0.02,0.01", "warm_up,Without warm-up,100 to 300,50,0.9,0.01,5,5",
            "warm_up,Without warm-up,200 to 300,50,0.9,0.01,-0.04,0.03",
            "steps,Without steps,100,50,0.9,0.01,-0.5,0.1", "steps,Without steps,100 to 300,50,0.9,0.01,5,5",
            "steps,Without steps,200 to 300,50,0.9,0.01,-0.2,0.05")))

    def writeNuisances(self):
        return self.writeLines("nuisances.csv", NUISANCES, "none,100,20,0.9,0.7,0.97,0,0,0.16",
                               "none,500,20,1,0.84,1,0.9,0.7,0.97", "thin_rod,100,20,0,0,0.16,0,0,0.16",
                               "thin_rod,500,20,0.5,0.3,0.7,0,0,0.16")

    def drawAblation(self):
        """Returns (names of the rows, {label: (values, bars)}, edges of the vertical axis)."""
        variants, frames = ablation_compared.read_differences(self.writeAblation())
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            ablation_compared.draw_figure(figure, variants, frames)
            axes = figure.axes[0]
            drawn = {label: (figure_case.drawn_points(axes, label), bars(axes, label))
                     for label in ("100 frames", LATER)}
            return [tick.get_text() for tick in axes.get_yticklabels()], drawn, axes.get_ylim()

    def test_the_most_harmful_ablation_stands_on_top_and_the_preset_is_left_out(self):
        names, _, (bottom, top) = self.drawAblation()
        self.assertEqual(names, ["Without steps", "Without warm-up"])
        self.assertGreater(bottom, top)  # row 0 is on top

    def test_dots_are_differences_at_first_and_over_the_later_frames(self):
        _, drawn, _ = self.drawAblation()
        self.assertEqual([x for x, _ in drawn["100 frames"][0]], [-0.5, 0.02])
        self.assertEqual([x for x, _ in drawn[LATER][0]], [-0.2, -0.04])
        for row in range(2):
            first, later = drawn["100 frames"][0][row][1], drawn[LATER][0][row][1]
            self.assertLess(first, later)  # the first is above the other, both in their row
            self.assertAlmostEqual(first + later, 2.0 * row)

    def test_bars_are_two_standard_errors_to_each_side(self):
        _, drawn, _ = self.drawAblation()
        for (left, right), expected in zip(drawn["100 frames"][1] + drawn[LATER][1],
                                           ((-0.7, -0.3), (0.0, 0.04), (-0.3, -0.1), (-0.1, 0.02))):
            self.assertAlmostEqual(left, expected[0])
            self.assertAlmostEqual(right, expected[1])

    def test_a_single_number_of_frames_is_one_dot_in_a_row(self):
        path = self.writeAblation("preset,Full preset,100,50,0.9,0.01,0,0", "steps,Without steps,100,5,0.9,0.01,-1,0")
        self.assertEqual(ablation_compared.read_differences(path)[1], ["100"])
        self.assertDrawn(ablation_compared, [path], COLUMN_WIDTH)

    def test_an_interval_need_not_be_symmetric(self):
        names, series = nuisances_compared.read_series(self.writeNuisances())
        self.assertEqual((names, [each.label for each in series]), (["none", "thin rod"], ["100 images", "500 images"]))
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = draw_figure_of_dots(figure, names, series, 2)
            self.assertEqual([x for x, _ in figure_case.drawn_points(axes, "500 images")], [1.0, 0.5])
            self.assertEqual([x for x, _ in figure_case.drawn_points(axes, "100 images")], [0.9, 0.0])
            for (left, right), expected in zip(bars(axes, "500 images") + bars(axes, "100 images"),
                                               ((0.84, 1.0), (0.3, 0.7), (0.7, 0.97), (0.0, 0.16))):
                self.assertAlmostEqual(left, expected[0])
                self.assertAlmostEqual(right, expected[1])

    def test_both_tables_make_a_picture_as_wide_as_a_column(self):
        self.assertDrawn(ablation_compared, [self.writeAblation()], COLUMN_WIDTH)
        os.remove(self.out)
        self.assertDrawn(nuisances_compared, [self.writeNuisances()], COLUMN_WIDTH)

    def test_a_variant_that_lacks_a_row_is_named(self):
        path = self.writeAblation("preset,Full preset,100,50,0.9,0.01,0,0", "preset,Full preset,200,50,0.9,0.01,0,0",
                                  "steps,Without steps,100,50,0.9,0.01,0,0")
        self.assertRefused(ablation_compared, [path], "steps", "100", "200")

    def test_the_preset_alone_is_nothing_to_draw(self):
        path = self.writeAblation("preset,Full preset,100,50,0.9,0.01,0,0")
        self.assertRefused(ablation_compared, [path], path)

    def test_missing_tables_are_named_with_the_remedy(self):
        for module in (ablation_compared, nuisances_compared):
            self.assertRefused(module, ["missing.csv"], "missing.csv", "rosrun ddm_launch reproduce_efficient")
