# The feature plane: what is drawn where, the decoded grid, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

from ddm_launch.command import Failure
from ddm_launch.figure_style import COLUMN_WIDTH, new_figure
from ddm_model.feature_grid import BRIGHTEST, DARKEST, FeatureGrid
import figure_case
from ddm_study import feature_plane

HEADER = "frame,set,x_px,y_px,z_1,z_2"
ROWS = ("0,training,1,1,-1.0,0.0", "1,training,1,1,1.0,0.5", "2,held_out,1,1,0.0,0.25")


class FeaturePlaneTest(figure_case.FigureCase):
    def makeFolder(self, name, schedule):
        """A folder of prediction_experiment with a real model."""
        self.writeLines(os.path.join(name, "features.csv"), HEADER, *ROWS)
        self.writeLines(os.path.join(name, "config.yaml"), "training:", "  schedule: %s" % schedule)
        folder = self.file(name)
        shutil.copy(figure_case.make_run(self.file("run_" + name)), os.path.join(folder, "model.ddm"))
        return folder

    def test_the_grid_is_read_like_a_page_and_each_image_lies_around_its_feature(self):
        grid = FeatureGrid((-1.0, 0.0), (1.0, 4.0))
        self.assertEqual(len(grid.features), 81)
        self.assertEqual(grid.features[0], (-1.0, 4.0))
        self.assertEqual(grid.features[1], (-0.75, 4.0))
        self.assertEqual(grid.features[-1], (1.0, 0.0))
        self.assertEqual(grid.extent, (-1.125, 1.125, -0.25, 4.25))

    def test_the_decoded_images_stand_at_their_features(self):
        grid = FeatureGrid((-1.0, -1.0), (1.0, 1.0))
        with new_figure(COLUMN_WIDTH, 3.0) as figure:
            axes = figure.add_subplot(1, 1, 1)
            grid.draw(axes, figure_case.GreyDecoder("").decode(grid.features))
            picture = axes.images[0].get_array()
            self.assertEqual(tuple(axes.images[0].get_extent()), grid.extent)
        self.assertEqual(picture.shape, (72, 72))
        for row, column in ((0, 0), (0, 8), (3, 2), (8, 8)):
            grey = DARKEST + (BRIGHTEST - DARKEST) * 3 * (9 * row + column) / 255.0
            self.assertAlmostEqual(picture[8 * row + 4, 8 * column + 4], grey, delta=0.03)

    def test_the_grid_covers_all_features_of_both_sets(self):
        left, right, bottom, top = feature_plane.grid_around([(-1.0, 0.0), (1.0, 0.5), (0.0, 2.0)]).extent
        self.assertLess(left, -1.0)
        self.assertGreater(right, 1.0)
        self.assertLess(bottom, 0.0)
        self.assertGreater(top, 2.0)
        self.assertLess(right - left, 3.0)  # and not much more than that

    def test_features_that_lie_on_a_line_are_refused(self):
        with self.assertRaisesRegex(Failure, r"\[-1, 1\] x \[0.5, 0.5\]"):
            feature_plane.grid_around([(-1.0, 0.5), (1.0, 0.5)])

    def test_an_unknown_set_and_features_of_three_numbers_are_refused(self):
        self.writeLines("features.csv", HEADER, "0,validation,1,1,0,0")
        with self.assertRaisesRegex(Failure, "column set.*validation"):
            feature_plane.read_features(self.scratch)
        self.writeLines("features.csv", HEADER + ",z_3", "0,training,1,1,0,0,0")
        with self.assertRaisesRegex(Failure, "features.csv .*two"):
            feature_plane.read_features(self.scratch)

    def test_a_configuration_without_schedule_is_refused(self):
        self.writeLines("features.csv", HEADER, *ROWS)
        self.writeLines("config.yaml", "training: {}")
        self.assertRefused(feature_plane, [self.scratch], "config.yaml", "training/schedule")

    def test_a_folder_without_features_is_named_with_the_remedy(self):
        self.writeLines("config.yaml", "training: {schedule: joint}")
        self.assertRefused(feature_plane, [self.scratch], "features.csv", "prediction_experiment")
