# The film strip: which trial and steps it shows, its pictures, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import math
import os
from unittest import mock

from PIL import Image

from ddm_launch import film_strip
from ddm_launch.run_folder import read_trials
from figure_case import call_figure
from run_files import changes, fingerprint
from scratch_case import ScratchCase
import synthetic_run


class GreyCamera:
    """Stands in for the simulator where only the layout matters: the brightness tells the angle."""

    plant = {"goal": [math.pi, 0.0], "tolerance": 10.0}

    def __init__(self, _folder):
        pass

    def shoot(self, angle_rad, _rate_rad_per_s):
        return Image.new("L", (51, 51), round(80 * abs(angle_rad)) % 256)


class FilmStripTest(ScratchCase):
    def setUp(self):
        super().setUp()
        self.run_folder, self.strip, self.gif = (self.file(name) for name in ("run", "strip.png", "swing_up.gif"))
        synthetic_run.write_run(self.run_folder)

    def callMain(self, *arguments, make_camera=GreyCamera):
        with mock.patch.object(film_strip, "Camera", make_camera):
            return call_figure(film_strip, self.run_folder, "--out", self.strip, *arguments)

    def test_the_last_success_is_shown_by_default(self):
        code, output = self.callMain()
        self.assertEqual(code, 0, output)
        self.assertRegex(output, r"\btrial 1\b")

    def test_the_last_trial_is_shown_when_none_succeeded(self):
        synthetic_run.write_trials(self.run_folder, ["0", "", "0"], ["170", "20", "90"])
        self.assertEqual(film_strip.default_trial(read_trials(self.run_folder)), 2)

    def test_a_trial_can_be_chosen(self):
        self.assertRegex(self.callMain("--trial", "2")[1], r"\btrial 2\b")

    def test_the_strip_ends_a_little_after_the_target_is_reached_for_good(self):
        angles = [math.pi * min(1.0, k / 16.0) for k in range(100)]
        self.assertEqual(film_strip.swing_up_end(angles, math.pi, math.radians(10.0)), 21)  # within 10 degrees from step 16 on
        passing = angles[:30] + [1.0] + [-math.pi] * 69  # overshoots once, then stays: the arrival is step 31
        self.assertEqual(film_strip.swing_up_end(passing, math.pi, math.radians(10.0)), 38)
        tips = [0.2 * k for k in range(15)]  # where up is 0, the rod begins there
        self.assertEqual(film_strip.swing_up_end(tips[::-1] + [0.0] * 85, 0.0, math.radians(8.0)), 19)

    def test_a_swing_up_that_never_arrives_is_shown_to_its_end(self):
        self.assertEqual(film_strip.swing_up_end([0.01 * k for k in range(50)], math.pi, 0.1), 49)

    def test_images_are_evenly_spaced_and_reach_the_end(self):
        self.assertEqual(film_strip.steps_to_show(22, 100), list(range(0, 23, 2)))
        self.assertEqual(film_strip.steps_to_show(21, 100), list(range(0, 23, 2)))
        self.assertEqual(film_strip.steps_to_show(99, 100), list(range(0, 100, 9)))
        self.assertEqual(film_strip.steps_to_show(3, 4), [0, 1, 2, 3])

    def test_the_strip_is_drawn_where_one_is_by_default_and_not_into_the_run(self):
        before = fingerprint(self.run_folder)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.scratch)
        with mock.patch.object(film_strip, "Camera", GreyCamera):
            code, output = call_figure(film_strip, self.run_folder)
        self.assertEqual(code, 0, output)
        self.assertEqual(sorted(os.listdir(self.scratch)), ["film_strip.png", "run"])
        self.assertEqual(changes(before, fingerprint(self.run_folder)), [])

    def test_the_animation_runs_in_real_time(self):
        self.assertEqual(self.callMain("--gif", self.gif)[0], 0)
        with Image.open(self.gif) as animation:
            self.assertEqual(animation.n_frames, 22)
            self.assertEqual(animation.info["duration"], 200)

    def test_the_simulator_draws_the_images(self):
        code, output = self.callMain(make_camera=film_strip.Camera)
        self.assertEqual(code, 0, output)
        with Image.open(self.strip) as picture:
            self.assertGreater(picture.width, 3 * picture.height)
        camera = film_strip.Camera(self.run_folder)
        hanging, upright = camera.shoot(0.0, 0.0), camera.shoot(-math.pi, 0.0)
        self.assertEqual(hanging.size, (51, 51))
        self.assertNotEqual(hanging.tobytes(), upright.tobytes())

    def test_an_animation_that_cannot_be_completed_is_named_and_nothing_of_it_is_left(self):
        self.assertEqual(self.callMain("--gif", self.gif)[0], 0)
        size = os.path.getsize(self.gif)
        self.assertGreater(size, os.path.getsize(self.strip))
        os.remove(self.gif)
        os.remove(self.strip)
        self.limitFiles(size - 1)
        code, output = self.callMain("--gif", self.gif)
        self.assertEqual(code, 1)
        self.assertIn(self.gif, output)
        self.assertEqual(sorted(os.listdir(self.scratch)), ["run", "strip.png"])

    def test_a_plant_that_does_not_exist_is_named(self):
        synthetic_run.write_config(self.run_folder, plant="no_such_plant")
        code, output = self.callMain(make_camera=film_strip.Camera)
        self.assertEqual(code, 1)
        self.assertIn("no_such_plant", output)

    def test_a_trial_without_evaluation_is_named(self):
        code, output = self.callMain("--trial", "7")
        self.assertEqual(code, 1)
        self.assertIn("evaluation_007", output)

    def test_torques_that_do_not_match_the_trajectory_are_refused(self):
        path = os.path.join(self.run_folder, "evaluation_001", "torques.csv")
        with open(path) as stream:
            lines = stream.readlines()
        with open(path, "w") as stream:
            stream.writelines(lines[:-1])
        code, output = self.callMain()
        self.assertEqual(code, 1)
        self.assertIn("got 40 and 39", output)

    def test_a_configuration_without_plant_is_refused(self):
        with open(os.path.join(self.run_folder, "config.yaml"), "w") as stream:
            stream.write("experiment: {}\n")
        code, output = self.callMain(make_camera=film_strip.Camera)
        self.assertEqual(code, 1)
        self.assertIn("experiment/plant", output)

    def test_a_configuration_that_is_no_text_is_named(self):
        path = os.path.join(self.run_folder, "config.yaml")
        with open(path, "wb") as stream:
            stream.write(b"experiment: {plant: pend\xfclum}\n")
        code, output = self.callMain(make_camera=film_strip.Camera)
        self.assertEqual(code, 1)
        self.assertIn(path, output)
