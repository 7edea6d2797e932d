# The film: what it shows of a run that both programs made, how long, and what it refuses.
# SPDX-License-Identifier: BSD-3-Clause
import os
import shutil

import numpy as np
from PIL import Image

from ddm_launch import film
from ddm_model.model import load
from figure_case import call_figure
from processes import run_experiment
from scratch_case import SharedScratchCase

DT, STEPS = 0.2, 5  # the pendulum's, and a second of it


class FilmTest(SharedScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_folder = os.path.join(cls.class_scratch, "run")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 1, "--out", cls.run_folder)
        assert code == 0, output

    def evaluation(self, trial):
        return os.path.join(self.run_folder, "evaluation_%03d" % trial)

    def assertRefused(self, arguments, *words):
        code, output = call_figure(film, *arguments, "--out", self.file("film.webp"))
        self.assertEqual(code, 1, output)
        for word in words:
            self.assertIn(word, output)
        self.assertFalse(os.path.exists(self.file("film.webp")))

    def test_evaluations_are_shown_one_after_the_other_in_real_time(self):
        out = self.file("film.webp")
        code, output = call_figure(film, self.evaluation(0), self.evaluation(1), "--seconds", "2", "--out", out)
        self.assertEqual(code, 0, output)
        with Image.open(out) as picture:
            self.assertEqual(picture.n_frames, 2 * 11)
            durations = []
            for frame in range(picture.n_frames):
                picture.seek(frame)
                picture.load()
                durations.append(picture.info["duration"])
        self.assertEqual(durations, 2 * (10 * [200] + [film.LAST_MS]))

    def test_what_was_expected_is_what_the_model_says_a_second_before(self):
        clip = film.read_clip(self.evaluation(1))
        self.assertEqual(clip.title, "pendulum, after 60 images (12 s)")
        model, now = load(os.path.join(self.run_folder, "trial_001", "model.ddm")), 20
        images, torques = film.simulate(self.run_folder, self.evaluation(1))
        self.assertEqual((len(images), torques.shape[1]), (len(clip.images), 1))
        self.assertEqual(clip.expected[:1 + STEPS], (1 + STEPS) * [None])  # two images are needed, and a second
        then = now - STEPS
        ahead = model.roll_out(model.encode(images[then - 1:then + 1]), torques[then - 1:now])
        np.testing.assert_allclose(clip.expected[now], np.clip(255.0 * model.decode(ahead[-1:])[0], 0, 255))
        self.assertEqual(len(clip.paths[then]), 1 + STEPS)
        self.assertEqual(clip.landmarks.shape, (len(model.landmarks), 2))
        self.assertGreater(len(model.landmarks), 10)

    def test_other_folders_and_files_are_refused(self):
        self.assertRefused([self.run_folder], "evaluation_NNN", self.run_folder)
        broken = self.file("broken")
        shutil.copytree(self.run_folder, broken)
        os.remove(os.path.join(broken, "trial_001", "model.ddm"))
        self.assertRefused([os.path.join(broken, "evaluation_001")], "trial_001/model.ddm")
        lost = self.file("lost")
        code, output = run_experiment("--preset", "debug", "--seed", 1, "--trials", 0, "--nuisance", "drops", "--out", lost)
        self.assertEqual(code, 0, output)
        self.assertRefused([os.path.join(lost, "evaluation_000")], "lost frames", "camera/drop_rate")
        code, output = call_figure(film, self.evaluation(0), "--out", self.file("film.png"))
        self.assertEqual(code, 1)
        self.assertIn(".webp", output)
