# The strip of long-term predictions: which images stand where, the real image programs, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

from ddm_launch.command import Failure
from ddm_launch.figure_style import PAGE_WIDTH, new_figure
from ddm_launch.images import Camera, Decoder
import figure_case
import synthetic_run
from ddm_study import prediction_strip


class PredictionStripTest(figure_case.FigureCase):
    def writeStrip(self, *lines):
        return self.writeLines("strip.csv", "steps,angle_rad,rate_rad_per_s,z_1,z_2", *lines)

    def writeWholeStrip(self):
        return self.writeStrip(*("%d,%d,0,0.%d,-0.5" % (k, 10 * k, k) for k in range(9)))

    def test_true_images_stand_above_predicted_ones_step_by_step(self):
        self.writeWholeStrip()
        decoder = figure_case.GreyDecoder("")
        with new_figure(PAGE_WIDTH, 2.0) as figure:
            prediction_strip.draw_strip(figure, prediction_strip.Strip(self.scratch), figure_case.GreyCamera(""),
                                        decoder)
            self.assertEqual(len(figure.axes), 18)
            shown = [axes.images[0].get_array()[0, 0] for axes in figure.axes]
            titles = [axes.get_title() for axes in figure.axes[:9]]
            rows = [figure.axes[0].get_ylabel(), figure.axes[9].get_ylabel()]
            heights = [axes.get_position().y0 for axes in (figure.axes[0], figure.axes[9])]
        self.assertEqual(shown, [0, 10, 20, 30, 40, 50, 60, 70, 80] + list(range(0, 27, 3)))
        self.assertEqual(titles, ["now", "+1", "+2", "+3", "+4", "+5", "+6", "+7", "+8"])
        self.assertEqual(rows, ["true", "predicted"])
        self.assertGreater(heights[0], heights[1])
        self.assertEqual(decoder.features[3], [0.3, -0.5])

    def test_the_images_of_simulator_and_model_make_a_picture(self):
        self.writeWholeStrip()
        run = self.file("run")
        shutil.copy(figure_case.make_run(run), self.file("model.ddm"))
        shutil.copy(os.path.join(run, "config.yaml"), self.scratch)
        self.assertDrawn(prediction_strip, [self.scratch], PAGE_WIDTH)

    def test_a_model_decodes_each_feature_of_a_list_in_order(self):
        decoder = Decoder(figure_case.make_run(self.file("run")))
        images = decoder.decode([(-1.0, 0.5), (1.0, -0.5), (1.0, -0.5)])
        self.assertEqual([image.size for image in images], [(51, 51)] * 3)
        self.assertEqual(images[1].tobytes(), images[2].tobytes())
        self.assertNotEqual(images[0].tobytes(), images[1].tobytes())
        with self.assertRaisesRegex(Failure, r"model.ddm: needs 2 feature\(s\)"):
            decoder.decode([(1.0,), (2.0,)])

    def test_the_camera_sees_the_tile_where_it_is(self):
        synthetic_run.write_config(self.scratch, plant="moving_tile")
        camera = Camera(self.scratch)
        left, right = camera.shoot(12.0, 20.0), camera.shoot(38.0, 20.0)
        for image, x in ((left, 12), (right, 38)):
            box = image.point(lambda grey: 255 if grey > 127 else 0).getbbox()
            self.assertAlmostEqual((box[0] + box[2]) / 2.0, x, delta=1.5)

    def test_a_model_that_is_none_is_named(self):
        self.writeWholeStrip()
        synthetic_run.write_config(self.scratch)
        self.assertRefused(prediction_strip, [self.scratch], self.file("model.ddm"))

    def test_a_folder_without_strip_is_named_with_the_remedy(self):
        self.assertRefused(prediction_strip, [self.scratch], self.file("strip.csv"),
                           "prediction_experiment")

    def test_a_strip_without_true_state_or_features_is_refused(self):
        self.writeLines("strip.csv", "steps,z_1,z_2", "0,1,1")
        with self.assertRaisesRegex(Failure, "strip.csv"):
            prediction_strip.Strip(self.scratch)
        self.writeLines("strip.csv", "steps,angle_rad", "0,1")
        with self.assertRaisesRegex(Failure, "no column z_1"):
            prediction_strip.Strip(self.scratch)

    def test_a_cell_that_is_no_number_is_named(self):
        for word in ("", "nan", "inf", "one"):
            self.writeStrip("0,0,0,0,%s" % word)
            with self.assertRaisesRegex(Failure, "column z_2 .*got '%s'" % word):
                prediction_strip.Strip(self.scratch)
