# Predicted distributions of the angle against actual runs: panels, bands, lines, axes, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
import math

from ddm_study import pilco_runs, trajectory_distributions
from ddm_launch.figure_style import PAGE_WIDTH, BLUE, ORANGE, VERMILLION, new_figure
import figure_case

HEADER = ",".join(pilco_runs.DISTRIBUTION_COLUMNS)


def rows(seed, trial, kind, end_rad, std_rad="", num_steps=20):
    """The angle grows evenly up to end_rad."""
    return ["%d,%d,%d,%s,%d,%.3f,%.17g,%s" % (seed, trial, 125 * (trial + 1), kind, k, 0.2 * k,
                                              end_rad * k / (num_steps - 1), std_rad) for k in range(num_steps)]


def policy(seed, trial, end_rad=math.pi, std_rad=0.3):
    return (rows(seed, trial, "predicted", end_rad, std_rad) + rows(seed, trial, "evaluation", 0.9 * end_rad) +
            rows(seed, trial, "trial", 0.8 * end_rad))


class TrajectoryDistributionsTest(figure_case.FigureCase):
    def panels(self, lines, seconds=None):
        """Draws these rows; returns one dictionary per panel, row by row."""
        seeds = trajectory_distributions.read_distributions(self.writeLines("angles.csv", HEADER, *lines))
        with new_figure(PAGE_WIDTH, 3.0) as figure:
            trajectory_distributions.draw_all(figure, seeds, seconds)
            return [{"title": axes.get_title(), "label": axes.get_ylabel(), "ylim": axes.get_ylim(),
                     "xlim": axes.get_xlim(), "lines": [(line.get_color(), round(line.get_ydata()[-1], 6))
                                                        for line in axes.lines],
                     "band": [band.get_paths()[0].get_extents() for band in axes.collections]}
                    for axes in figure.axes[:-1]]

    def test_each_seed_has_a_row_and_each_number_of_frames_a_column(self):
        panels = self.panels(policy(4, 2) + policy(4, 0) + policy(1, 0) + policy(1, 2))
        self.assertEqual([panel["title"] for panel in panels], ["125 frames", "375 frames", "", ""])
        self.assertEqual([panel["label"] for panel in panels], ["seed 1\nangle [rad]", "", "seed 4\nangle [rad]", ""])

    def test_a_panel_shows_the_predicted_mean_and_both_actual_runs(self):
        panel, = self.panels(policy(0, 0))
        self.assertEqual(panel["lines"], [(BLUE, 1.0), (VERMILLION, 0.9), (ORANGE, 0.8)])

    def test_the_band_is_two_standard_deviations_to_each_side(self):
        panel, = self.panels(policy(0, 0, math.pi, 0.3))
        band, = panel["band"]
        self.assertAlmostEqual(band.y0, -0.6 / math.pi)
        self.assertAlmostEqual(band.y1, 1.0 + 0.6 / math.pi)

    def test_the_last_policy_is_drawn_without_a_further_trial(self):
        panel, = self.panels(rows(0, 0, "predicted", 1.0, 0.1) + rows(0, 0, "evaluation", 1.0))
        self.assertEqual(len(panel["lines"]), 2)

    def test_a_policy_that_a_seed_lacks_leaves_its_panel_empty(self):
        panels = self.panels(policy(0, 0) + policy(0, 1) + policy(1, 1))
        self.assertEqual([len(panel["lines"]) for panel in panels], [3, 3, 0, 3])

    def test_only_the_first_seconds_are_shown_where_asked_for(self):
        panel, = self.panels(policy(0, 0, 2.0 * math.pi, 0.0), seconds=1.9)
        self.assertEqual(panel["xlim"], (0.0, 1.9))
        self.assertEqual(panel["ylim"], (-1.3, 1.3))  # what comes later does not widen the axis

    def test_three_seeds_of_six_policies_make_a_picture_as_wide_as_a_page(self):
        lines = [row for seed in range(3) for trial in (0, 1, 2, 3, 5, 7) for row in policy(seed, trial)]
        path = self.writeLines("angles.csv", HEADER, *lines)
        self.assertDrawn(trajectory_distributions, [path], PAGE_WIDTH)
        self.assertDrawn(trajectory_distributions, [path, "--seconds", "2.5"], PAGE_WIDTH)

    def test_files_that_make_no_sense_are_refused(self):
        self.assertRefused(trajectory_distributions, ["missing.csv"], "missing.csv", "reproduce_paper")
        for lines, *parts in ((["0,0,125,guessed,0,0,0,0"], "column kind", "predicted, evaluation, trial", "'guessed'"),
                              (rows(0, 0, "predicted", 1.0), "column angle_std_rad", ">= 0", "got None"),
                              (rows(0, 0, "predicted", 1.0, -0.1), "column angle_std_rad", ">= 0", "got -0.1"),
                              (policy(0, 0) + policy(0, 0), "seed 0, frames 125, kind predicted, step 0")):
            path = self.writeLines("angles.csv", HEADER, *lines)
            self.assertRefused(trajectory_distributions, [path], path, *parts)

    def test_a_time_that_is_none_ends_with_code_2(self):
        for text in ("0", "-1", "nan", "inf", "long"):
            code, output = self.callMain(trajectory_distributions, "angles.csv", "--seconds=" + text)
            self.assertEqual(code, 2)
            for part in ("--seconds", "> 0 [s]", "got '%s'" % text):
                self.assertIn(part, output)
