# Angle trajectories by trial: panels, lines, who counts as upright, and what is refused.
# SPDX-License-Identifier: BSD-3-Clause
import math

from ddm_study import angle_trajectories
from ddm_launch.figure_style import BLUE, PAGE_WIDTH, VERMILLION, new_figure
import figure_case

HEADER = "seed,frames,success,step,time_s,angle_rad"


def rows(seed, frames, end_rad, num_steps=20, start_s=0.0):
    """A trajectory that reaches end_rad half-way and stays there; a success if that is pi or -pi."""
    success = abs(end_rad) == math.pi
    return ["%d,%d,%d,%d,%.17g,%.17g" % (seed, frames, success, k, start_s + 0.2 * k,
                                         end_rad * min(1.0, 2.0 * k / num_steps)) for k in range(num_steps)]


class AngleTrajectoriesTest(figure_case.FigureCase):
    def panels(self, *trajectories):
        """Draws and returns one (title, [(colour, last angle / pi)], ylim) per trial."""
        path = self.writeLines("angles.csv", HEADER, *(row for trajectory in trajectories for row in trajectory))
        with new_figure(PAGE_WIDTH, 3.0) as figure:
            angle_trajectories.draw_all(figure, angle_trajectories.read_trajectories(path))
            return [(axes.get_title(), [(line.get_color(), line.get_ydata()[-1]) for line in axes.lines],
                     axes.get_ylim()) for axes in figure.axes[:-1]]

    def test_each_trial_has_a_panel_with_one_line_per_seed(self):
        panels = self.panels(rows(1, 2, math.pi), rows(1, 1, 0.5 * math.pi), rows(2, 2, -math.pi))
        self.assertEqual([panel[0] for panel in panels], ["1 frames: 0 of 1", "2 frames: 2 of 2"])
        self.assertEqual(panels[0][1], [(VERMILLION, 0.5)])
        self.assertEqual(sorted(panels[1][1]), [(BLUE, -1.0), (BLUE, 1.0)])

    def test_who_succeeds_is_what_the_file_says(self):
        falls = [row.replace("1,100,0,", "1,100,1,", 1) for row in rows(1, 100, 0.3)]
        self.assertEqual(self.panels(falls)[0][:2], ("100 frames: 1 of 1", [(BLUE, 0.3 / math.pi)]))

    def test_time_starts_at_zero_and_the_order_of_the_rows_does_not_matter(self):
        path = self.writeLines("angles.csv", HEADER, *reversed(rows(1, 1, math.pi, start_s=37.0)))
        trajectory = angle_trajectories.read_trajectories(path)[1][1]
        self.assertAlmostEqual(trajectory.time_s[0], 0.0)
        self.assertAlmostEqual(trajectory.time_s[-1], 3.8)
        self.assertAlmostEqual(trajectory.end_s, 4.0)
        self.assertEqual(trajectory.angle_rad[0], 0.0)

    def test_the_drawn_target_is_the_region_that_counts(self):
        with new_figure(PAGE_WIDTH, 3.0) as figure:
            path = self.writeLines("angles.csv", HEADER, *rows(1, 1, 1.0))
            angle_trajectories.draw_all(figure, angle_trajectories.read_trajectories(path))
            spans = [patch.get_path().get_extents(patch.get_patch_transform()) for patch in figure.axes[0].patches]
        edges = sorted((round(span.y0 * 180.0), round(span.y1 * 180.0)) for span in spans)
        self.assertIn((170, 190), edges)
        self.assertIn((-190, -170), edges)

    def test_fifteen_trials_of_sixteen_seeds_make_a_picture_as_wide_as_a_page(self):
        lines = [row for trial in range(1, 16) for seed in range(16) for row in rows(seed, trial, math.pi * seed / 15)]
        self.assertDrawn(angle_trajectories, [self.writeLines("angles.csv", HEADER, *lines)], PAGE_WIDTH)

    def test_a_file_that_is_missing_or_lacks_a_column_is_named(self):
        self.assertRefused(angle_trajectories, ["missing.csv"], "missing.csv", "reproduce_paper")
        path = self.writeLines("angles.csv", "seed,step,time_s", "1,0,0")
        self.assertRefused(angle_trajectories, [path], path, "frames, angle_rad, success")

    def test_a_step_that_is_there_twice_is_refused(self):
        path = self.writeLines("angles.csv", HEADER, *(rows(1, 1, 1.0) + rows(1, 1, 2.0)))
        self.assertRefused(angle_trajectories, [path], "seed 1, frames 1, step 0")
